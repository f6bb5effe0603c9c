#include "core/geometry/intersections/axial_bounds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace remesh {
namespace {

/// The slack for distances along the axes, relative to a point's distance from the line's first vertex. It is far more
/// than their rounding error.
constexpr double kRounding = 0x1p-44;

/// The slack for angles, in turns. It is far more than the rounding error of angles, their sums and their differences.
constexpr double kAngleRounding = 0x1p-44;

/// The number of faces between two checks for cancellation.
constexpr std::size_t kFacesPerCheck = 1 << 14;

constexpr AxialBounds::Arc kEverything{0, 1};

/// The turn from one angle on to another, at least 0 and at most 1.
double turn(double from, double to) {
  const double way = to - from;
  return way - std::floor(way);
}

AxialBounds::Arc joined(const AxialBounds::Arc& a, const AxialBounds::Arc& b) {
  if (a.length < 0) return b;
  if (b.length < 0) return a;
  const auto from_on = [](const AxialBounds::Arc& first, const AxialBounds::Arc& last) {
    return AxialBounds::Arc{first.begin, std::max(first.length, turn(first.begin, last.begin) + last.length)};
  };
  const AxialBounds::Arc from_a = from_on(a, b), from_b = from_on(b, a);
  const AxialBounds::Arc& shorter = from_a.length <= from_b.length ? from_a : from_b;
  return shorter.length < 1 ? shorter : kEverything;
}

}  // namespace

AxialBounds::AxialBounds(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces,
                         VertexId from, VertexId to, RunControl& control)
    : positions_(positions), from_(from), to_(to) {
  const Vec3 along = normalized(positions[to.value] - positions[from.value]);
  const double x = std::fabs(along.x), y = std::fabs(along.y), z = std::fabs(along.z);
  Vec3 across;
  across[x <= y && x <= z ? 0 : y <= z ? 1 : 2] = 1;
  axes_[0] = normalized(cross(along, across));
  axes_[1] = cross(along, axes_[0]);
  std::size_t faces_seen = 0;
  arcs_ = tree.joined<Arc>(
      [&](std::size_t slot) {
        if (++faces_seen % kFacesPerCheck == 0) control.check_and_move();
        return arc_of(faces[tree.face(slot).value]);
      },
      joined, control);
}

AxialBounds::Arc AxialBounds::arc_of(const Triangle& face) const {
  constexpr double kLargestDoubt = 0.01;
  Arc arc;
  double doubt = kAngleRounding;
  for (const VertexId v : face) {
    if (v == from_ || v == to_) continue;
    const Vec3 way = positions_[v.value] - positions_[from_.value];
    const Vec2 flat{dot(axes_[0], way), dot(axes_[1], way)};
    const double distance = norm(flat), rounding = kRounding * norm(way);
    if (!(rounding < kLargestDoubt * distance)) return kEverything;
    doubt = std::max(doubt, kAngleRounding + rounding / distance);
    arc = joined(arc, {std::atan2(flat.y, flat.x) / (2 * std::numbers::pi), 0});
  }
  // A face that is seen under half a turn or more may reach across the line. A face whose corners are all on the line's
  // two vertices lies on it.
  return arc.length >= 0 && arc.length + 2 * doubt < 0.5 ? Arc{arc.begin - doubt, arc.length + 2 * doubt} : kEverything;
}

bool AxialBounds::are_apart(const Arc& arc, std::size_t node) const {
  const Arc& other = arcs_[node];
  if (other.length < 0) return true;
  const double way = turn(arc.begin, other.begin);
  return way > arc.length + kAngleRounding && way + other.length < 1 - kAngleRounding;
}

}  // namespace remesh
