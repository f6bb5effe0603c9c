/// Measures distances between two sets of triangles by brute force, as an oracle for proven bounds.
#pragma once

#include <vector>

#include "core/geometry/triangles/distances.h"

namespace remesh::test {

/// Returns the largest distance of points of `from` from the triangles `to`, by branch and bound.
/// Output: a lower bound, which is too small by no more than `accuracy`.
/// Source: Tang, Lee, Kim, Interactive Hausdorff distance computation for general polygonal models, 2009. The distance
///         from a triangle is convex, so over another triangle it is largest at a corner.
double hausdorff_one_way(const std::vector<Corners3>& from, const std::vector<Corners3>& to, double accuracy);
/// Returns the larger one of the two distances.
double hausdorff(const std::vector<Corners3>& a, const std::vector<Corners3>& b, double accuracy);

}  // namespace remesh::test
