#include "core/patches/recognition/surface_seeds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "core/base/stoppable.h"
#include "core/geometry/surfaces/surface_fit.h"

namespace remesh {
namespace {

/// A cone whose apex is further away than this many lengths of a facet is taken for a cylinder.
constexpr double kMaxApex = 1e4;

double squared_distance_from_line(const Vec3& p, const Vec3& a, const Vec3& direction) {
  const Vec3 q = p - a;
  return norm_squared(q - dot(q, direction) * direction);
}

/// Returns the corner that is farthest from a line.
const Vec3& farthest(std::span<const Vec3> corners, const Vec3& a, const Vec3& direction) {
  const Vec3* best = &corners[0];
  double max_distance = -1;
  for (const Vec3& p : corners) {
    const double distance = squared_distance_from_line(p, a, direction);
    if (distance > max_distance) {
      max_distance = distance;
      best = &p;
    }
  }
  return *best;
}

/// Returns where the line through two corners of a facet meets the line through a and b, as a multiple of the way from
/// a to b. The two lines lie in one plane up to rounding.
std::optional<double> meeting_of(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const Vec3 u = b - a, v = q - p, w = p - a;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
  const double det = uu * vv - uv * uv;
  if (!(det > 1e-20 * uu * vv)) return std::nullopt;
  return (dot(w, u) * vv - dot(w, v) * uv) / det;
}

}  // namespace

SurfaceSeed make_seed(const FacetGraph& graph, PatchId facet, std::uint32_t side, std::uint32_t end_side) {
  const Vec3 &a = graph.position(graph.vertex(side)), &b = graph.position(graph.vertex(end_side));
  const Vec3 sum = a + b;
  // These factors have no simple ratio, so that the edges of a symmetric part have different sums.
  const double tie = 0.7548776662466927 * sum.x + 0.5698402909980532 * sum.y + 0.3247179572447460 * sum.z;
  return {norm_squared(b - a), tie, side, end_side, facet, SurfaceKinds::all()};
}

bool is_in_sample(const SurfaceSeed& seed, double part) {
  // The later digits of a number look random.
  constexpr double kLaterDigits = 0x1.9e3779b97f4a8p20;
  const double digits = kLaterDigits * seed.tie;
  return digits - std::floor(digits) < part;
}

bool SeedQueue::is_before(const SurfaceSeed& s, const SurfaceSeed& t) const {
  if (s.length_squared != t.length_squared) return s.length_squared > t.length_squared;
  if (s.tie != t.tie) return s.tie < t.tie;
  const auto ends_of = [&](const SurfaceSeed& seed) {
    const Vec3 &a = graph_.position(graph_.vertex(seed.side)), &b = graph_.position(graph_.vertex(seed.end_side));
    return a < b ? std::pair(a, b) : std::pair(b, a);
  };
  return ends_of(s) < ends_of(t);
}

/// Sorts until the first `end` seeds are in order.
void SeedQueue::sort_to(std::size_t end) {
  const auto at = [&](std::size_t i) { return seeds_.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto less = [&](const SurfaceSeed& s, const SurfaceSeed& t) { return is_before(s, t); };
  if (kStep * end >= seeds_.size()) end = seeds_.size();
  control_.check();
  if (end < seeds_.size()) std::nth_element(at(sorted_), at(end), seeds_.end(), less);
  sort_stoppable(at(sorted_), at(end), control_, less);
  sorted_ = end;
}

ConeApexes guess_apexes(std::span<const Vec3> first, std::span<const Vec3> second, const Vec3& a, const Vec3& b) {
  const auto apex_of = [&](std::span<const Vec3> facet) -> std::optional<double> {
    if (facet.size() != 4) return std::nullopt;
    std::array<Vec3, 4> others;
    std::size_t count = 0;
    for (const Vec3& p : facet)
      if (p != a && p != b) others[count++] = p;
    return count == 2 ? meeting_of(a, b, others[0], others[1]) : std::nullopt;
  };
  const std::optional<double> s = apex_of(first), t = apex_of(second);
  if (s && t) {
    const double mean = 0.5 * (*s + *t);
    // If the edge is a ruling, both facets give the same apex. The relative error grows with the distance.
    if (std::fabs(*s - *t) < 0.2 * (1 + std::fabs(mean)) && std::fabs(mean) < kMaxApex) return {{mean, 0}, 1};
  } else if (s || t) {
    if (std::fabs(s ? *s : *t) < kMaxApex) return {{s ? *s : *t, 0}, 1};
  } else if (first.size() == 3 && second.size() == 3) {
    return {{0, 1}, 2};
  }
  return {};
}

const std::vector<AnalyticSurface>& SeedGuesses::of(const SurfaceSeed& seed) {
  guesses_.clear();
  first_.clear();
  second_.clear();
  graph_.for_each_corner(seed.facet, [&](const Vec3& p) { first_.push_back(p); });
  graph_.for_each_corner(graph_.beyond(seed.side), [&](const Vec3& p) { second_.push_back(p); });
  const Vec3& a = graph_.position(graph_.vertex(seed.side));
  const Vec3& b = graph_.position(graph_.vertex(seed.end_side));
  points_ = first_;
  points_.insert(points_.end(), second_.begin(), second_.end());
  if (seed.kinds.has(SurfaceKind::kSphere))
    if (const auto sphere = guess_sphere(points_)) guesses_.push_back(*sphere);
  if (seed.kinds.has(SurfaceKind::kCylinder)) guess_cylinder_along(a, b);
  if (seed.kinds.has(SurfaceKind::kCone)) guess_cones(a, b);
  return guesses_;
}

void SeedGuesses::guess_cylinder_along(const Vec3& a, const Vec3& b) {
  const Vec3 axis = normalized(b - a);
  if (norm_squared(axis) == 0) return;
  // The circle through three rulings: the edge, and the farthest corners of both facets.
  const Vec3 &f = farthest(first_, a, axis), &g = farthest(second_, a, axis);
  const std::array<Vec3, 3> rulings{a, f, g};
  if (const auto cylinder = guess_cylinder(rulings, axis)) guesses_.push_back(*cylinder);
}

void SeedGuesses::guess_cones(const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a, direction = normalized(along);
  const Vec3 &f = farthest(first_, a, direction), &g = farthest(second_, a, direction);
  const auto guess_with_apex = [&](double t) {
    const Vec3 apex = a + t * along;
    const Vec3 u = normalized((t < 0.5 ? b : a) - apex), v = normalized(f - apex), w = normalized(g - apex);
    Vec3 axis = normalized(cross(v - u, w - u));
    const double cosine = dot(axis, u);
    if (cosine < 0) axis = -axis;
    const double angle = std::acos(std::min(1.0, std::fabs(cosine)));
    if (!(angle > 1e-9) || !(std::fabs(cosine) > 1e-9)) return;
    guesses_.push_back({SurfaceKind::kCone, apex, axis, 0, 0, angle});
  };
  const ConeApexes apexes = guess_apexes(first_, second_, a, b);
  for (std::size_t i = 0; i < apexes.count; ++i) guess_with_apex(apexes.at[i]);
}

}  // namespace remesh
