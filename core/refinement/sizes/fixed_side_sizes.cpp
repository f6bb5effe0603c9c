#include "core/refinement/sizes/fixed_side_sizes.h"

#include <cmath>
#include <numbers>

#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

constexpr double kMinDegrees = 20;
/// The slope of shrinking sizes is this multiple of the slope of the best graded triangles. With a smaller multiple,
/// too large an area stays coarse; with a larger one, triangles become flat. See experiments.md, Fixed sides.
constexpr double kSteeper = 1.5;

Vec3 in_space(Vec2 p) { return {p.x, p.y, 0}; }

/// Returns how fast sizes can shrink. Consider triangles that are built on one another's sides and all have two angles
/// equal to the bound. Each is smaller than the one before by the factor 1/(2 cos), and its height is tan/2 times its
/// base.
double steepest_slope(double min_angle_deg) {
  const double angle = std::max(min_angle_deg, kMinDegrees) * std::numbers::pi / 180;
  return kSteeper * (1 - 1 / (2 * std::cos(angle))) * 2 / std::tan(angle);
}

}  // namespace

FixedSideSizes::FixedSideSizes(std::span<const FixedSide> sides, double min_angle_deg, RunControl& control)
    : steepest_(steepest_slope(min_angle_deg)) {
  std::vector<BoxTree<Shrinking>::Entry> entries;
  entries.reserve(sides.size());
  for (const FixedSide& side : sides) {
    FloatBox box;
    box.add(in_space(side.from));
    box.add(in_space(side.to));
    const double length = norm(side.to - side.from);
    // A side that is only a little too long needs little room for sizes to shrink. With this slope, all sides reach the
    // size that is asked for at the same fraction of their length.
    entries.push_back({box, {length, steepest_ * std::max(0.0, 1 - side.size / length)}});
  }
  tree_ = BoxTree<Shrinking>(entries, control);
  sides_.resize(sides.size());
  for (std::size_t slot = 0; slot < sides.size(); ++slot) sides_[slot] = sides[tree_.number(slot)];
}

double FixedSideSizes::at(Vec2 place) const {
  const Vec3 p = in_space(place);
  double least = 0;  // the negative of the max size so far, because the search finds minima
  tree_.search(
      least,
      [&](const BoxTree<Shrinking>::Entry& e) {
        return e.tag.slope * std::sqrt(squared_distance(e.box, p)) - e.tag.size;
      },
      [&](std::size_t slot) {
        const auto& [size, slope] = tree_[slot].tag;
        const Vec3 nearest = nearest_on_segment(p, in_space(sides_[slot].from), in_space(sides_[slot].to));
        least = std::min(least, slope * norm(nearest - p) - size);
      });
  return -least;
}

}  // namespace remesh
