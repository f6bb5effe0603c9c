/// A triangulated patch.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/patch_types/patch_reason.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// A triangulated patch, in the plane of its chart (patch_chart.h). If there is no triangulation, `reason`
/// says why.
struct PatchMesh {
  std::vector<VertexId> vertices;  ///< in lexicographic order of their plane coordinates; refinement appends to them
  std::vector<Vec2> uv;            ///< one per vertex
  Triangulation2d mesh;            ///< over `vertices`; boundary edges are constrained
  /// Edges inside the patch that are constrained only so that no flip can replace them. A flip would make an edge that
  /// exists elsewhere on the surface already, and the chord rule forbids that (core/README.md, Glossary, chord). They
  /// are in no boundary loop.
  std::set<std::pair<std::uint32_t, std::uint32_t>> reserved;
  /// This is true if constrained edges along rulings divide a curved patch into strips. Then no edge of the
  /// triangulation turns too far.
  bool has_rulings = false;
  std::uint32_t loops = 0;
  PatchReason reason = PatchReason::kNone;

  bool is_reserved(std::uint32_t h) const { return reserved.count(std::minmax(mesh.from(h), mesh.to(h))) != 0; }
};

/// The triangulated patches of a surface.
using PatchMeshes = IdVector<PatchId, PatchMesh>;

}  // namespace remesh
