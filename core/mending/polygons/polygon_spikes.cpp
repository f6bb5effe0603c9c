#include "core/mending/polygons/polygon_spikes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/stoppable.h"
#include "core/geometry/planes/projection.h"
#include "core/mending/polygons/faces_without_area.h"

namespace remesh {
namespace {

/// Returns whether the way over three places turns back at the second one. Tolerance 0 means exactly.
bool does_turn_back(const Vec3& from, const Vec3& tip, const Vec3& to, double tolerance) {
  const Vec3 back = from - tip, on = to - tip;
  if (!(dot(back, on) > 0)) return false;
  if (is_collinear(from, tip, to)) return true;
  const double shorter = std::min(norm(back), norm(on)), longer = std::max(norm(back), norm(on));
  return tolerance > 0 && shorter > 2 * tolerance && norm(cross(back, on)) <= tolerance * longer;
}

/// Returns whether a polygon has a spike, or corners within the tolerance of each other, which may hide one. Most
/// polygons have neither.
bool may_have_spikes(std::span<const Vec3> points, double tolerance, const RunControl& control) {
  StopCheck check(control);
  const std::size_t n = points.size();
  for (std::size_t i = 0; i < n; ++i) {
    check();
    const Vec3 &from = points[i == 0 ? n - 1 : i - 1], &tip = points[i], &to = points[i + 1 == n ? 0 : i + 1];
    if (norm_squared(to - tip) <= tolerance * tolerance || does_turn_back(from, tip, to, tolerance)) return true;
  }
  return false;
}

/// The corners of a polygon as a ring from which corners can be removed.
class Ring {
 public:
  /// `leaves` is empty or has one flag per corner. With Reversals::kKeep, the tip of an exact reversal is cut off if
  /// its flag is 1. The tips of all other exact reversals stay.
  Ring(std::span<const Vec3> points, double tolerance, Reversals reversals, std::span<const std::uint8_t> leaves = {})
      : points_(points),
        tolerance_(tolerance),
        reversals_(reversals),
        leaves_(leaves),
        count_(static_cast<std::uint32_t>(points.size())) {
    next_.resize(count_);
    before_.resize(count_);
    for (std::uint32_t i = 0; i < count_; ++i) {
      next_[i] = i + 1 == count_ ? 0 : i + 1;
      before_[next_[i]] = i;
    }
    is_there_.assign(count_, 1);
    if (reversals_ == Reversals::kKeepSlits) area_vector_ = newell_normal(points);
    waiting_.resize(count_);
    std::iota(waiting_.rbegin(), waiting_.rend(), 0u);
  }

  Spikes cut(const RunControl& control) {
    StopCheck check(control);
    Spikes spikes;
    while (!waiting_.empty() && count_ >= 3) {
      check();
      const std::uint32_t tip = waiting_.back();
      waiting_.pop_back();
      if (!is_there_[tip]) continue;
      if (is_reversal_that_stays(tip)) continue;
      const auto [from, to] = sides_of(tip);
      if (!turns_back(from, tip, to)) continue;
      if (reversals_ == Reversals::kKeepSlits && is_slit(from, tip, to)) continue;
      // If the tip is blunt, the corners beside it are cut off first.
      while (next_[from] != tip) take(next_[from], spikes);
      while (next_[tip] != to) take(next_[tip], spikes);
      take(tip, spikes);
      // The foot of a spike becomes one corner.
      if (are_one(from, to)) take(to, spikes);
      waiting_.push_back(next_[from]);
      waiting_.push_back(from);
    }
    if (count_ < 3 || spikes.needles.empty()) return spikes;
    for (std::uint32_t i = 0; i < is_there_.size(); ++i)
      if (is_there_[i]) spikes.outline.push_back(i);
    return spikes;
  }

 private:
  struct Sides {
    std::uint32_t from, to;
  };

  bool is_reversal_that_stays(std::uint32_t tip) const {
    if (reversals_ == Reversals::kCut || points_[before_[tip]] != points_[next_[tip]]) return false;
    return leaves_.empty() || leaves_[tip] == 0;
  }

  bool are_one(std::uint32_t i, std::uint32_t j) const {
    return points_[i] == points_[j] || norm(points_[i] - points_[j]) <= tolerance_;
  }

  /// The corners on both sides of a tip that do not count as one with the tip. In most cases these are its neighbours.
  Sides sides_of(std::uint32_t tip) const {
    constexpr int kMaxSteps = 3;
    Sides sides{before_[tip], next_[tip]};
    for (int i = 0; i < kMaxSteps && are_one(sides.from, tip) && before_[sides.from] != sides.to; ++i)
      sides.from = before_[sides.from];
    for (int i = 0; i < kMaxSteps && are_one(sides.to, tip) && next_[sides.to] != sides.from; ++i)
      sides.to = next_[sides.to];
    return sides;
  }

  bool turns_back(std::uint32_t from, std::uint32_t tip, std::uint32_t to) const {
    // Nothing would be left of a triangle, so a triangle with an area is not cut.
    return does_turn_back(points_[from], points_[tip], points_[to], count_ > 3 ? tolerance_ : 0);
  }

  /// Returns whether the outline comes back to where it left, with the polygon's inside around the tip.
  bool is_slit(std::uint32_t from, std::uint32_t tip, std::uint32_t to) const {
    const Vec3 turn = cross(points_[tip] - points_[from], points_[to] - points_[tip]);
    return are_one(from, to) && dot(turn, area_vector_) < 0;
  }

  void take(std::uint32_t corner, Spikes& spikes) {
    spikes.needles.push_back({before_[corner], corner, next_[corner]});
    next_[before_[corner]] = next_[corner];
    before_[next_[corner]] = before_[corner];
    is_there_[corner] = 0;
    --count_;
  }

  std::span<const Vec3> points_;
  double tolerance_;
  Reversals reversals_;
  std::span<const std::uint8_t> leaves_;
  Vec3 area_vector_;  ///< proportional to the area vector; only set if slits are looked for
  std::uint32_t count_;
  std::vector<std::uint32_t> next_, before_;
  std::vector<std::uint8_t> is_there_;
  std::vector<std::uint32_t> waiting_;  ///< the corners to look at; the next one is at the end
};

/// The plane of an outline, and how far from it the corners of a slit may be.
struct OutlinePlane {
  Vec3 normal, centre;
  double reach = 0;

  double distance(const Vec3& p) const { return std::fabs(dot(p - centre, normal)); }
};

OutlinePlane plane_of(std::span<const Vec3> points, std::span<const std::uint32_t> outline, double plane_tolerance,
                      StopCheck& check) {
  std::vector<Vec3> loop;
  loop.reserve(outline.size());
  OutlinePlane plane;
  for (const std::uint32_t i : outline) {
    check();
    loop.push_back(points[i]);
    plane.centre += (1.0 / static_cast<double>(outline.size())) * points[i];
  }
  plane.normal = normalized(newell_normal(loop));
  plane.reach = plane_tolerance;
  for (const Vec3& p : loop) {
    check();
    plane.reach = std::max(plane.reach, plane.distance(p));
  }
  return plane;
}

/// Marks the corners of spikes that are out of the plane's reach, and the corners further out on the same spikes.
/// Output: whether any corner was marked.
bool mark_leaving(std::span<const Vec3> points, const Spikes& spikes, const OutlinePlane& plane, double tolerance,
                  std::vector<std::uint8_t>& leaves, StopCheck& check) {
  const auto are_one = [&](std::uint32_t i, std::uint32_t j) {
    return points[i] == points[j] || norm(points[i] - points[j]) <= tolerance;
  };
  leaves.assign(points.size(), 0);
  bool is_any = false;
  // The needle that was cut last is next to the outline. In reverse order, the base of a spike is known before the
  // spike itself.
  for (auto needle = spikes.needles.rbegin(); needle != spikes.needles.rend(); ++needle) {
    check();
    const auto [before, tip, next] = *needle;
    const bool is_of_leaving = are_one(before, tip) ? leaves[before] != 0
                               : are_one(tip, next) ? leaves[next] != 0
                                                    : leaves[before] != 0 || leaves[next] != 0;
    leaves[tip] = is_of_leaving || plane.distance(points[tip]) > plane.reach;
    is_any = is_any || leaves[tip] != 0;
  }
  return is_any;
}

}  // namespace

Spikes cut_spikes(std::span<const Vec3> points, double tolerance, Reversals reversals, const RunControl& control) {
  if (!may_have_spikes(points, tolerance, control)) return {};
  return Ring(points, tolerance, reversals).cut(control);
}

PlaneSpikes cut_spikes_out_of_plane(std::span<const Vec3> points, double tolerance, double plane_tolerance,
                                    const RunControl& control) {
  StopCheck check(control);
  const Spikes all = cut_spikes(points, tolerance, Reversals::kCut, control);
  std::vector<std::uint8_t> leaves;
  if (all.outline.size() >= 3) {
    const OutlinePlane plane = plane_of(points, all.outline, plane_tolerance, check);
    if (plane.normal != Vec3{} && mark_leaving(points, all, plane, tolerance, leaves, check))
      return {Ring(points, tolerance, Reversals::kKeep, leaves).cut(control), true};
  }
  return {cut_spikes(points, tolerance, Reversals::kKeep, control), false};
}

bool is_needle(const Vec3& a, const Vec3& b, const Vec3& c, double tolerance) {
  const double longest = std::max({norm(b - a), norm(c - b), norm(a - c)});
  return norm(cross(b - a, c - a)) <= tolerance * longest;
}

}  // namespace remesh
