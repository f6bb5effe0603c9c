/// A triangulated patch.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/frame.h"
#include "core/geometry/patch_reason.h"
#include "core/geometry/triangulation_2d.h"

namespace remesh {

/// A triangulated patch. `reason` says why there is none.
struct PatchMesh {
  Frame frame;                     ///< model units
  std::vector<VertexId> vertices;  ///< in lexicographic order of their plane coordinates; refinement adds to the end
  std::vector<Vec2> uv;            ///< one per vertex
  Triangulation2d mesh;            ///< over `vertices`; boundary edges are constrained
  std::set<std::pair<std::uint32_t, std::uint32_t>> held;  ///< constrained for the chord rule alone: not of any loop
  std::uint32_t loops = 0;
  PatchReason reason = PatchReason::kNone;

  bool is_held(std::uint32_t h) const { return held.count(std::minmax(mesh.from(h), mesh.to(h))) != 0; }
};

}  // namespace remesh
