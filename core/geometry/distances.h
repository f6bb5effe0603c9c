/// Distances between points and triangles in space, to rounding.
#pragma once

#include <array>

#include "core/base/vec.h"

namespace remesh {

using Corners3 = std::array<Vec3, 3>;

/// The point of the segment or triangle that is nearest to p. Without extent or area it is the set of its points.
Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);
Vec3 nearest_on_triangle(const Vec3& p, const Corners3& triangle);

/// From one triangle to another that does not cross it, by the shortest way. Where they cross, it is not null, but some
/// way between their borders and faces.
Vec3 shortest_way(const Corners3& s, const Corners3& t);

}  // namespace remesh
