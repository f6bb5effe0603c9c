/// A triangulated patch.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/patch_types/patch_reason.h"
#include "core/triangulation/inline_vector.h"
#include "core/triangulation/rare.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// Edges of a triangulation, by their ends. Most sets are empty and hold no memory.
class EdgeSet {
 public:
  bool empty() const { return !ends_ || ends_->empty(); }
  bool has(std::uint32_t a, std::uint32_t b) const { return ends_ && ends_->count(std::minmax(a, b)) != 0; }
  void insert(std::uint32_t a, std::uint32_t b) { ends_.get().insert(std::minmax(a, b)); }
  void erase(std::uint32_t a, std::uint32_t b) {
    if (ends_) ends_->erase(std::minmax(a, b));
  }

 private:
  Rare<std::set<std::pair<std::uint32_t, std::uint32_t>>> ends_;
};

/// A triangulated patch, in the plane of its chart (patch_chart.h). If there is no triangulation, `reason`
/// says why.
struct PatchMesh {
  /// In lexicographic order of their plane coordinates. Refinement appends to them.
  InlineVector<VertexId, 3> vertices;
  InlineVector<Vec2, 3> uv;  ///< one per vertex
  Triangulation2d mesh;      ///< over `vertices`; boundary edges are constrained
  /// Edges inside the patch that are constrained only so that no flip can replace them. A flip would make an edge that
  /// exists elsewhere on the surface already, and the chord rule forbids that (core/README.md, Glossary, chord). They
  /// are in no boundary loop.
  EdgeSet reserved;
  /// This is true if constrained edges along rulings divide a curved patch into strips. Then no edge of the
  /// triangulation turns too far.
  bool has_rulings = false;
  std::uint32_t loops = 0;
  PatchReason reason = PatchReason::kNone;

  bool is_reserved(std::uint32_t h) const { return reserved.has(mesh.from(h), mesh.to(h)); }
};

/// The triangulated patches of a surface.
using PatchMeshes = IdVector<PatchId, PatchMesh>;

}  // namespace remesh
