/// Reads back what was written, by readers that share nothing with the project's.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/io/formats.h"

namespace remesh::mutate {

struct WrittenMesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> faces;
  bool has_floats = false;       ///< coordinates are floats, and not doubles
  bool has_own_vertices = true;  ///< false: every face brought its corners (STL)
};

/// Output: the mesh; nothing for a format that is not read here.
/// Errors: std::runtime_error - it is not what the format says, an index leads nowhere, a coordinate is not finite.
std::optional<WrittenMesh> read_written(Format format, const std::string& bytes);

/// Every number in the JSON text is finite and the text is JSON. Errors: std::runtime_error.
void expect_finite_json(const std::string& text);

}  // namespace remesh::mutate
