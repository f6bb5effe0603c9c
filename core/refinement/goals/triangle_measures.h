/// Measures triangles in the plane.
#pragma once

#include <algorithm>

#include "core/base/vec.h"

namespace remesh {

/// The numbers by which a triangle is judged.
struct TriangleMeasures {
  double squares, shortest_squared, longest_squared;  ///< sum, minimum and maximum of the squares of its edges
  double twice_area;

  /// Returns twice the area over the sum of the squared edges. A larger value means a better shape. It is negative if
  /// the triangle is turned over.
  double shape() const { return twice_area / squares; }
};

/// Measures the triangle between a point and an edge.
inline TriangleMeasures measure_spanned(Vec2 p, Vec2 a, Vec2 b) {
  const Vec2 base = b - a, u = a - p, v = b - p;
  const double squared[3] = {dot(base, base), dot(u, u), dot(v, v)};
  const auto [shortest, longest] = std::minmax({squared[0], squared[1], squared[2]});
  return {squared[0] + squared[1] + squared[2], shortest, longest, cross(u, v)};
}

}  // namespace remesh
