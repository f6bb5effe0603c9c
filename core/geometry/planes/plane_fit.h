/// The plane nearest to a set of points.
#pragma once

#include <array>

#include "core/base/vec.h"

namespace remesh {

/// Sums over a set of points, from which its least-squares plane follows. The sums of two sets can be added.
struct PointMoments {
  double count = 0;
  Vec3 sum;
  std::array<double, 6> products{};  ///< sums of the products xx, xy, xz, yy, yz, zz

  void add(const Vec3& p);
  void merge(const PointMoments& other);
  Vec3 mean() const { return (1 / count) * sum; }
};

/// The principal axes of a set of points, orthonormal up to rounding, and the mean squares of the points' coordinates
/// along them.
struct PrincipalAxes {
  std::array<Vec3, 3> axes;
  std::array<double, 3> squares;
};
/// Source: Jacobi's rotations.
PrincipalAxes principal_axes(const PointMoments& moments);

/// The unit normal of the least-squares plane, in either direction, and the points' root mean square distance from the
/// plane. The points should be within about 1 of the origin. A distance below some 1e-8 of the points' spread is
/// rounding error.
struct PlaneFit {
  Vec3 normal;
  double rms = 0;
};
/// Source: the eigenvector of the covariance's least eigenvalue.
PlaneFit fit_plane(const PointMoments& moments);

}  // namespace remesh
