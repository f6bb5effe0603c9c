/// A triangle that is prepared for measuring its distance from many points.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/vec.h"
#include "core/geometry/triangles/distances.h"

namespace remesh::verification {

/// A triangle as the target of distances.
/// Input:   corners with coordinates of at most 1, and points likewise.
/// Holds:   the root of `squared_distance` is the distance to some point of the triangle, up to kRounding. So it is
///          never below the true distance by more than that, even if the triangle has no area and rounding decides
///          which of its points is taken for the nearest one. That one is the nearest one up to rounding unless the
///          triangle's height is below 2^-46 of its longest side.
/// Source:  rules.md, Near faces.
class DistanceTarget {
 public:
  /// A bound on the rounding of a distance. With u = 2^-53, each of some 25 operations on lengths up to 2 sqrt(3) errs
  /// by u of its result, and the root of a sum of three squares by 4 u of it. This makes 25 * 3.47 u + 4 * 3.47 u, or
  /// 101 u. The local coordinates of the triangle and of the point err by sqrt(3) / 2 u each. All this is below 128 u.
  static constexpr double kRounding = 0x1p-46;

  explicit DistanceTarget(const Corners3& corners) {
    // The longest side goes from `base_` along `side_[0]`. All other vectors are measured across it, so that needles
    // lose no digits.
    double squared[3];
    for (int i = 0; i < 3; ++i) squared[i] = norm_squared(corners[(i + 1) % 3] - corners[i]);
    const int first = squared[0] >= squared[1] && squared[0] >= squared[2] ? 0 : squared[1] >= squared[2] ? 1 : 2;
    base_ = corners[first];
    side_[0] = corners[(first + 1) % 3] - base_;
    side_[1] = corners[(first + 2) % 3] - base_;
    side_[2] = side_[1] - side_[0];
    per_squared_[0] = inverse(squared[first]);
    per_squared_[1] = inverse(squared[(first + 2) % 3]);
    per_squared_[2] = inverse(squared[(first + 1) % 3]);
    foot_ = dot(side_[1], side_[0]) * per_squared_[0];
    height_ = side_[1] - foot_ * side_[0];
    const double squared_height = norm_squared(height_);
    constexpr double kThin = 0x1p-92;
    per_squared_height_ = squared_height > kThin * squared[first] ? inverse(squared_height) : 0;
  }

  double squared_distance(const Vec3& p) const {
    const Vec3 from_base = p - base_;
    const double along = dot(from_base, side_[0]) * per_squared_[0];
    const Vec3 across = from_base - along * side_[0];
    // The weights of the three corners. If the triangle is thin, the third corner has none, and the other two stand for
    // the longest side.
    const double apex = dot(across, height_) * per_squared_height_;
    const double end = along - apex * foot_;
    if (apex >= 0 && end >= 0 && apex + end <= 1) return norm_squared(across - apex * height_);
    double least = HUGE_VAL;
    if (!(apex > 0)) least = norm_squared(from_base - std::clamp(along, 0.0, 1.0) * side_[0]);
    if (!(end > 0)) least = std::min(least, to_side(from_base, 1));
    if (!(apex + end < 1)) least = std::min(least, to_side(from_base - side_[0], 2));
    return least;
  }

  double squared_longest_side() const { return norm_squared(side_[0]); }

 private:
  /// The inverse of a square; 0 for squares that are 0 or that say nothing.
  static double inverse(double squared) { return squared > 0x1p-900 ? 1 / squared : 0; }

  double to_side(const Vec3& from, int side) const {
    return norm_squared(from - std::clamp(dot(from, side_[side]) * per_squared_[side], 0.0, 1.0) * side_[side]);
  }

  Vec3 base_;
  Vec3
      side_[3];  ///< from the base to the end of the longest side, from the base to the apex, from that end to the apex
  double per_squared_[3];
  double foot_;  ///< where the apex is over the longest side, as a share of that
  Vec3 height_;  ///< from there to the apex
  double per_squared_height_;
};

}  // namespace remesh::verification
