/// Distances between points and triangles in space, to rounding.
#pragma once

#include <array>

#include "core/base/vec.h"

namespace remesh {

using Corners3 = std::array<Vec3, 3>;

/// The point of the segment or triangle that is nearest to p. Without extent or area it is the set of its points.
Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b);
Vec3 nearest_on_triangle(const Vec3& p, const Corners3& triangle);

/// The square of the distance between two triangles that do not cross. Where they do, it is not 0, but some distance
/// between their borders and faces.
double squared_distance(const Corners3& s, const Corners3& t);

}  // namespace remesh
