/// Which ways leave a patch steeply, and how long they are at least: what a gap is told by.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/vec.h"
#include "core/geometry/box_tree.h"
#include "core/geometry/plane.h"

namespace remesh {

/// What faces a patch is above it at more than 51 degrees (the square of the sine): two planes that meet see each other
/// below 39 degrees, as by the detour of GapSearch. Without it, every second facet of a round hole would be a gap to
/// the first.
constexpr double kSteep = 0.604;

/// Where all of a patch is.
struct Slab {
  Plane plane;
  double half_thickness = 0;

  double distance(const Vec3& p) const { return std::max(0.0, std::fabs(plane.distance(p)) - half_thickness); }
  bool is_steep(const Vec3& way) const {
    const double up = dot(way, plane.normal);
    return up * up > kSteep * norm_squared(way);
  }
};

/// The space between two parallel planes, about something flat that lies askew to the axes. A curved surface is thin
/// across: a box about a piece of width s is s deep, a layer s^2. So steepness, which depends on the way across, is
/// told for many triangles at once.
/// Input:  places with coordinates in [-1, 1], given with `add`.
/// Holds:  in single precision, rounded outwards: what is added is inside.
struct Layer {
  std::array<float, 3> across{0, 0, 0};  ///< a unit vector, to 2^-20; or null, then nothing is told
  float least = HUGE_VALF;               ///< of the products of `across` with what is inside
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

  /// More than a product is wrong by.
  static constexpr double kRounding = 0x1p-48;
};

/// Of the products of a layer's direction with some places.
struct Products {
  double least, most;
};

/// The square of the length of a steep way to what is in a box and in a layer, at least; infinity if there is none.
/// Input:  the slab of the patch that the way leaves; the products of the places it may leave from; the square of its
///         length at least, without steepness.
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

  // It is so far across to the layer, if it is not between.
  const bool is_along = layer.least > from.most;
  const double across =
      (is_along ? double{layer.least} - from.most : from.least - double{layer.most}) - Layer::kRounding;
  if (!(across > 0)) return squared_distance;
  // Steep ways lie in a cone about the normal. What matters is the one nearest the layer's direction.
  double cosine = (is_along ? 1 : -1) * dot(layer.direction(), slab.plane.normal);
  if (std::fabs(up) <= range) {
    cosine = std::fabs(cosine);  // a cone to either side
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
