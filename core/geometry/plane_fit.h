/// The plane nearest to a set of points.
#pragma once

#include <array>
#include <cstddef>

#include "core/base/vec.h"

namespace remesh {

/// Sums over points, from which the least-squares plane follows; sums of two sets add up.
struct PointMoments {
  double count = 0;
  Vec3 sum;
  std::array<double, 6> products{};  ///< of xx, xy, xz, yy, yz, zz

  void add(const Vec3& p);
  void merge(const PointMoments& other);
  Vec3 mean() const { return (1 / count) * sum; }
};

/// The axes of the points' covariance: orthonormal but for rounding, and the mean squares along them.
struct PrincipalAxes {
  std::array<Vec3, 3> axes;
  std::array<double, 3> squares;
};
/// Source: Jacobi's rotations.
PrincipalAxes principal_axes(const PointMoments& moments);

/// The unit normal of the least-squares plane, either way round, and the points' root mean square distance from it.
/// Points within about 1 of the origin: below some 1e-8 of their spread the distance is rounding.
struct PlaneFit {
  Vec3 normal;
  double rms = 0;
};
/// Source: the eigenvector of the covariance's least eigenvalue.
PlaneFit fit_plane(const PointMoments& moments);

}  // namespace remesh
