/// Exact orientation in space: a cheap filter first, then expansion arithmetic.
/// The coordinates' magnitudes must be 0 or within [2^-250, 2^250], so that no product under- or overflows;
/// `scaled_for_predicates` gets them there. In this range orient2d (predicates.h) is exact, too.
/// Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// Sign of the signed volume of abcd: > 0 if d is on the side of the plane abc from which abc is counter-clockwise,
/// < 0 on the other side, 0 exactly coplanar.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The positions times the power of two that brings the largest magnitude of a coordinate into [2^249, 2^250).
/// Input:  finite coordinates of any magnitude.
/// Holds:  predicates on the result have the sign of those on the input, as long as every coordinate that is not 0 is
///         at least 2^-499 of the largest; smaller ones may lose digits.
std::vector<Vec3> scaled_for_predicates(std::span<const Vec3> positions, RunControl& control);

/// The part of a predicate that the filter cannot decide. Call the predicate, not this.
namespace exact {

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace exact

/// The same where floating-point arithmetic is sure of it; 0 where it is not.
inline int certain_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  // Half an ulp of 1, and Shewchuk's bound on the relative error of the determinant (o3derrboundA).
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
