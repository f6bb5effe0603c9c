/// Whether two triangles of a surface meet where they should not, exactly.
#pragma once

#include <span>

#include "core/mesh/mesh.h"

namespace remesh {

/// Do two triangles have a point in common that is on none of their shared vertices and shared edges?
/// Touching counts; so does lying on each other: a face and its duplicate intersect.
/// Input:   corners with equal ids are shared, all others are not, wherever they are; coordinates in the range of
///          predicates_3d.h. A triangle without area is the set of its points, a segment or a point.
/// Holds:   the same for any order of the two and of their corners; exact.
/// Source:  the cases by shared vertices as in CGAL's self-intersection test; separating axes in a projection first,
///          which decides nearly all neighbours with predicates in the plane.
bool do_intersect(const Triangle& f, const Triangle& g, std::span<const Vec3> positions);

}  // namespace remesh
