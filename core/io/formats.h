/// Mesh formats: their names, telling them apart, reading and writing.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/report.h"

namespace remesh {

enum class Format { kObj, kJson, kStl, kPly, kOff, kVtu, kMsh };

/// Bounds on what a reader may build; passing one ends the read with Code::kMeshTooLarge.
struct ReadLimits {
  std::uint64_t max_vertices = 10'000'000;
  std::uint64_t max_faces = 20'000'000;
};

/// What a reader found: the mesh, and what it had to drop (`attribute_dropped`, ...).
struct ReadResult {
  PolygonMesh mesh;
  std::vector<Diagnostic> diagnostics;
};

}  // namespace remesh
