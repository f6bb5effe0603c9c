/// Measures how far two surfaces are apart, with CGAL's tree of boxes.
#pragma once

#include <vector>

#include <CGAL/Simple_cartesian.h>

namespace remesh::bench {

using DistanceKernel = CGAL::Simple_cartesian<double>;
using DistanceTriangle = DistanceKernel::Triangle_3;

struct SurfaceDistance {
  double lower = 0;  ///< some point of one surface is at least this far from the other
  double upper = 0;  ///< no point of one surface is farther from the other
};

/// Measures the largest distance of a point of one surface from the other, in both directions.
/// Input:   triangles; those without area are passed over.
/// Output:  bounds that differ by no more than 1 %, unless `upper` is at most `enough` or `lower` is above `too_far`.
/// Errors:  std::runtime_error if there are no triangles, or if the search takes too long.
/// Source:  Tang, Lee, Kim, Interactive Hausdorff distance computation for general polygonal models, 2009. The distance
///          from a triangle is convex, so over a part of another one it is largest at a corner of that part.
SurfaceDistance distance_between(const std::vector<DistanceTriangle>& a, const std::vector<DistanceTriangle>& b,
                                 double enough, double too_far);

}  // namespace remesh::bench
