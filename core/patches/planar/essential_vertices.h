/// Decides which vertices stay: the corners and junctions of patch boundaries, for all patches at once.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/planar/boundary_loops.h"

namespace remesh {

struct EssentialVertices {
  IdVector<VertexId, std::uint8_t> stays;  ///< one per vertex: 1 if it stays
  bool are_on_loops = true;                ///< no vertex that stays is inside a patch

  bool operator[](VertexId v) const { return stays[v] != 0; }
};

/// Marks the essential vertices.
/// Input:   vertices in `forced` stay in any case: the ladder forces some, and keep_boundary_vertices forces all of
///          them. `pinched` are the vertices that pinched_vertices finds. The plane tolerance is in local units.
/// Output:  the vertices that stay. A vertex inside a patch stays only if it is also a corner of a face that is not
///          connected there. Then the triangulation of the patch must have it as a point.
/// Holds:   a vertex goes only if
///          - it has exactly two patch-boundary edges in the whole mesh,
///          - its faces are connected around it, and
///          - it lies within the tolerance of the span between the staying vertices on either side, in order along it.
///          A closed boundary has three or more vertices that stay. No two spans join the same two vertices.
/// Cost:    O(n log n).
/// Source:  J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 4; rules.md, Essential vertices.
EssentialVertices essential_vertices(const Surface& surface, const Adjacency& adjacency, const BoundaryLoops& loops,
                                     const IdVector<VertexId, std::uint8_t>& forced, std::span<const VertexId> pinched,
                                     double tolerance, RunControl& control);

}  // namespace remesh
