/// Tests exactly whether two triangles of a surface meet where they should not.
#pragma once

#include <span>

#include "core/mesh/mesh.h"

namespace remesh {

/// Returns whether two triangles have a point in common that is on none of their shared vertices and shared edges.
/// Touching counts, and so does lying on each other: a face and its duplicate intersect.
/// Input:   corners with equal ids are shared; corners with different ids are not, wherever they are. The coordinates
///          must be in the range of predicates_3d.h. A triangle without area is the set of its points, a segment or a
///          point.
/// Holds:   the result is exact, and the same for any order of the two triangles and of their corners.
/// Source:  the cases by shared vertices are those of CGAL's self-intersection test. Before them, separating axes in a
///          projection decide nearly all neighbours with predicates in the plane.
bool do_intersect(const Triangle& f, const Triangle& g, std::span<const Vec3> positions);

}  // namespace remesh
