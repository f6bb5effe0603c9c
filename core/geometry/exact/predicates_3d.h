/// Exact orientation in space. A cheap filter decides most cases, and expansion arithmetic decides the others.
/// The magnitude of each coordinate must be 0 or within [2^-250, 2^250], so that no product under- or overflows.
/// `scaled_for_predicates` scales coordinates into this range. In it, orient2d (predicates.h) is exact, too.
/// Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// The sign of the signed volume of abcd: > 0 if d is on the side of the plane abc from which abc is counter-clockwise,
/// < 0 if it is on the other side, 0 if exactly coplanar.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Multiplies the positions by the power of two that brings the largest magnitude of a coordinate into [2^249, 2^250).
/// An axis along which all coordinates are below 2^-10 of the largest gets a larger power of two, which brings them to
/// about that size. So a model that is a billion times as long as it is wide is stretched, and searches that compare
/// boxes and directions with some slack for rounding can tell its faces apart. The same faces intersect before and
/// after the scaling.
/// Input:  finite coordinates of any magnitude.
/// Holds:  predicates have the same sign on the result as on the input, as long as every coordinate that is not 0 is at
///         least 2^-499 of the largest. Smaller coordinates may lose digits.
/// Errors: kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
std::vector<Vec3> scaled_for_predicates(std::span<const Vec3> positions, RunControl& control);

/// The part of a predicate that the filter cannot decide. Callers use the predicate above, not this.
namespace exact {

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace exact

/// The sign of orient3d if floating-point arithmetic is sure of it, otherwise 0.
inline int certain_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // kEpsilon is half an ulp of 1. The error bound is Shewchuk's, for the relative error of the determinant
  // (o3derrboundA).
  constexpr double kEpsilon = 0x1p-53;
  constexpr double kErrorBound = (7 + 56 * kEpsilon) * kEpsilon;
  const Vec3 ab = b - a, ac = c - a, ad = d - a;
  const double bc = ab.x * ac.y, cb = ac.x * ab.y;
  const double cd = ac.x * ad.y, dc = ad.x * ac.y;
  const double db = ad.x * ab.y, bd = ab.x * ad.y;
  const double determinant = ad.z * (bc - cb) + ab.z * (cd - dc) + ac.z * (db - bd);
  const double error = kErrorBound * (std::fabs(ad.z) * (std::fabs(bc) + std::fabs(cb)) +
                                      std::fabs(ab.z) * (std::fabs(cd) + std::fabs(dc)) +
                                      std::fabs(ac.z) * (std::fabs(db) + std::fabs(bd)));
  return determinant > error ? 1 : determinant < -error ? -1 : 0;
}

inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const int certain = certain_orient3d(a, b, c, d);
  return certain != 0 ? certain : exact::orient3d(a, b, c, d);
}

}  // namespace remesh
