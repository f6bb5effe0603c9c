/// Tells which straight ways leave a patch steeply, and gives lower bounds on their lengths. GapSearch recognises gaps
/// by this.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/vec.h"
#include "core/geometry/planes/plane.h"
#include "core/geometry/trees/box_tree.h"

namespace remesh {

/// A place faces a patch if it is above the patch's plane at more than 51 degrees; this constant is the square of the
/// sine of that angle. So two planes that meet see each other below 39 degrees, which agrees with the detour of
/// GapSearch. Without this rule, every second facet of a round hole would count as a gap to the first.
constexpr double kSteep = 0.604;

/// A slab contains all of a patch.
struct Slab {
  Plane plane;
  double half_thickness = 0;

  double distance(const Vec3& p) const { return std::max(0.0, std::fabs(plane.distance(p)) - half_thickness); }
  bool is_steep(const Vec3& way) const {
    const double up = dot(way, plane.normal);
    return up * up > kSteep * norm_squared(way);
  }
};

/// A layer is the space between two parallel planes around something flat that is askew to the axes. A curved surface
/// is thin across: a box about a piece of width s is s deep, a layer only about s^2. Steepness depends on the way
/// across, so with layers it is decided for many triangles at once.
/// Input: Places with coordinates in [-1, 1], which are added with `add`.
/// Holds: The numbers are in single precision and rounded outwards, so everything that was added is inside.
struct Layer {
  /// A unit vector, up to 2^-20. If it is null, the layer has no information.
  std::array<float, 3> across{0, 0, 0};
  float least = HUGE_VALF;  ///< smallest product of `across` with a place inside
  float most = -HUGE_VALF;

  Layer() = default;
  explicit Layer(const Vec3& unit) {
    for (int axis = 0; axis < 3; ++axis) across[axis] = static_cast<float>(unit[axis]);
  }

  Vec3 direction() const { return {across[0], across[1], across[2]}; }
  double product(const Vec3& p) const { return dot(direction(), p); }
  void add(const Vec3& p) {
    const double x = product(p);
    if (x - kRounding < double{least}) least = FloatBox::rounded_down(x - kRounding);
    if (x + kRounding > double{most}) most = -FloatBox::rounded_down(-x - kRounding);
  }

  /// This is larger than the rounding error of a product.
  static constexpr double kRounding = 0x1p-48;
};

/// The range of the products of a layer's direction with some places.
struct Products {
  double least, most;
};

/// Returns a lower bound for the square of the length of a steep way to any place in both a box and a layer. Returns
/// infinity if there is no such way.
/// Input: `slab` contains the patch that the way leaves. `from` has the products of the places where it may begin.
///        `squared_distance` is a lower bound for the square of its length, without regard to steepness.
inline double squared_steep_distance(const Slab& slab, Products from, const FloatBox& box, const Layer& layer,
                                     double squared_distance) {
  Vec3 centre, half;
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = 0.5 * (double{box.min[axis]} + box.max[axis]);
    half[axis] = std::fabs(slab.plane.normal[axis]) * 0.5 * (double{box.max[axis]} - box.min[axis]);
  }
  const double up = slab.plane.distance(centre);
  const double range = half.x + half.y + half.z + slab.half_thickness;
  const double most_up = std::fabs(up) + range;
  if (most_up * most_up <= kSteep * squared_distance) return HUGE_VAL;

  // The distance across to the layer. It counts only if the start is outside the layer.
  const bool is_along = layer.least > from.most;
  const double across =
      (is_along ? double{layer.least} - from.most : from.least - double{layer.most}) - Layer::kRounding;
  if (!(across > 0)) return squared_distance;
  // Steep ways lie in a cone about the normal. The one that is nearest to the layer's direction decides.
  double cosine = (is_along ? 1 : -1) * dot(layer.direction(), slab.plane.normal);
  if (std::fabs(up) <= range) {
    cosine = std::fabs(cosine);  // the cone has a part on either side
  } else if (up < 0) {
    cosine = -cosine;
  }
  constexpr double kSinglePrecision = 1e-6;
  static const double kInside = std::sqrt(kSteep), kOutside = std::sqrt(1 - kSteep);
  double nearest = 1;
  if (cosine < kInside) nearest = cosine * kInside + std::sqrt(std::max(0.0, 1 - cosine * cosine)) * kOutside;
  nearest += kSinglePrecision;
  return nearest > 0 ? std::max(squared_distance, across * across / (nearest * nearest)) : HUGE_VAL;
}

}  // namespace remesh
