/// One patch, from its loops to its triangles; all patches in parallel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/frame.h"
#include "core/geometry/triangulation_2d.h"
#include "core/options.h"
#include "core/report.h"
#include "core/stages/boundary_loops.h"
#include "core/stages/essential_vertices.h"
#include "core/stages/patches.h"

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

/// How patches are projected.
struct ProjectionRule {
  ReferenceAxis axis = ReferenceAxis::kDominantEdge;
  Vec3 direction;
};

/// Triangulates every patch from its essential vertices.
/// Output:  one mesh per patch, in patch order, whatever the number of threads.
/// Holds:   loops are kept; plane coordinates are multiples of 2^-40, or of 2^-100 where the coarser grid makes points
///          meet or loops cross. A patch of one triangle cannot fail.
/// Cost:    O(n log n); on the caller's TBB arena, by patch, large ones first.
std::vector<PatchMesh> mesh_patches(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                                    const BoundaryLoops& loops, const EssentialVertices& essential,
                                    const ProjectionRule& rule, RunControl& control);

}  // namespace remesh
