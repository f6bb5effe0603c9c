/// Distances between points and triangles in space, up to rounding.
#pragma once

#include <array>

#include "core/base/vec.h"

namespace remesh {

using Corners3 = std::array<Vec3, 3>;

/// The point of a segment or triangle that is nearest to p. A segment or triangle without extent counts as the set of
/// its points.
Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);
Vec3 nearest_on_triangle(const Vec3& p, const Corners3& triangle);

/// The shortest vector from one triangle to another, if they do not cross. If they cross, the result is the shortest
/// vector between a corner of one and the other one, or between two sides, and is not null.
Vec3 shortest_way(const Corners3& s, const Corners3& t);

}  // namespace remesh
