/// Exact geometric predicates in the plane. A cheap filter decides most cases. For the others, points on the lattice on
/// which patches lie are computed with integers, and other points with expansions.
/// The magnitude of each coordinate must be 0 or within [2^-120, 2^120], so that no product under- or overflows. Patch
/// frames guarantee this.
/// Source: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997.
#pragma once

#include <cmath>

#include "core/base/vec.h"

namespace remesh {

/// The sign of the signed area of abc: > 0 if counter-clockwise, < 0 if clockwise, 0 if exactly collinear.
int orient2d(Vec2 a, Vec2 b, Vec2 c);

/// For counter-clockwise abc: > 0 if d is inside their circle, < 0 if it is outside, 0 if exactly cocircular.
/// For clockwise abc, the sign is reversed.
int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

/// in_circle with ties broken. It is never 0 for four distinct points of which a, b, c are not collinear.
/// If the four points are cocircular, the lexicographically smallest one is moved inwards by an infinitesimal, so that
/// the Delaunay diagonal is the one at that point. Therefore there is one answer for any order of the input, and flips
/// do not cycle.
int in_circle_perturbed(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

/// The parts of predicates that the filter cannot decide. Callers use the predicates above, not these.
namespace exact {

int orient2d(Vec2 a, Vec2 b, Vec2 c);
int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);
int in_circle_tie(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

}  // namespace exact

inline int orient2d(Vec2 a, Vec2 b, Vec2 c) {
  // kEpsilon is half an ulp of 1. The error bound is Shewchuk's, for the relative error of the determinant
  // (ccwerrboundA).
  constexpr double kEpsilon = 0x1p-53;
  constexpr double kErrorBound = (3 + 16 * kEpsilon) * kEpsilon;
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  const double determinant = left - right;
  const double error = kErrorBound * (std::fabs(left) + std::fabs(right));
  if (determinant > error) return 1;
  if (determinant < -error) return -1;
  // Nothing underflows, so each of the two products has a factor that is exactly 0. In most cases, the points are on a
  // line along an axis.
  if (left == 0 && right == 0) return 0;
  return exact::orient2d(a, b, c);
}

inline int in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  // The constants are as above (iccerrboundA).
  constexpr double kEpsilon = 0x1p-53;
  constexpr double kErrorBound = (10 + 96 * kEpsilon) * kEpsilon;
  const Vec2 ad = a - d, bd = b - d, cd = c - d;
  const double bc = bd.x * cd.y, cb = cd.x * bd.y;
  const double ca = cd.x * ad.y, ac = ad.x * cd.y;
  const double ab = ad.x * bd.y, ba = bd.x * ad.y;
  const double a_lift = dot(ad, ad), b_lift = dot(bd, bd), c_lift = dot(cd, cd);
  const double determinant = a_lift * (bc - cb) + b_lift * (ca - ac) + c_lift * (ab - ba);
  const double error =
      kErrorBound * (a_lift * (std::fabs(bc) + std::fabs(cb)) + b_lift * (std::fabs(ca) + std::fabs(ac)) +
                     c_lift * (std::fabs(ab) + std::fabs(ba)));
  if (determinant > error) return 1;
  if (determinant < -error) return -1;
  return exact::in_circle(a, b, c, d);
}

inline int in_circle_perturbed(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const int sign = in_circle(a, b, c, d);
  return sign != 0 ? sign : exact::in_circle_tie(a, b, c, d);
}

}  // namespace remesh
