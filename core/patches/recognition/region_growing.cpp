#include "core/patches/recognition/region_growing.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/stoppable.h"
#include "core/patches/recognition/explained_height.h"

namespace remesh {
namespace {

/// The surface is fitted to at most this many facets while it grows, evenly chosen.
constexpr std::size_t kFitFacets = 64, kExactFitFacets = 256;

/// The work of testing one facet, and the work of a fit per point. The unit is about the time in which one distance is
/// computed.
constexpr std::uint64_t kWorkOfTest = 4, kWorkOfFit = 6;

/// A fit to growing facets begins near its end.
constexpr int kMaxFitSteps = 6;
constexpr double kSettledFit = 0.01;
constexpr std::size_t kFewFacets = 32;

/// A fit is good enough to grow further if the root mean square of the distances is this many tolerances.
constexpr double kGoodEnough = 0.2;

/// A facet was cut on purpose, like the flat on a shaft, if the surface turns over it by more than 2.6 times the
/// median. The factor is above 2, because programs make pieces at boundaries half as large as facets inside. It is
/// squared here for 1 - cos of small angles.
constexpr double kMaxUneven = 2.6 * 2.6;

/// All facets count as cut on purpose if the dropped ones have more than this part of the area of the others.
constexpr double kMaxDropped = 0.6;

/// The smallest number of circles about its axis on which the corners of a torus lie. Through three circles about one
/// axis there always is a torus, and through four that mirror each other as well.
constexpr int kMinRings = 5;

/// Rounding alone moves corners by this many tolerances. A surface is believed without doubt if this large a part of
/// its corners is that close to it. With many facets, the smaller part is enough.
constexpr double kCloseClaim = 0.1;
constexpr double kCloseOfFew = 0.9, kCloseOfMany = 0.5;
constexpr std::size_t kManyFacets = 40;

/// All other claims must end where the facets visibly leave the surface. The border is soft where the next facet leaves
/// the surface by at most this many chord heights, or is at most as large as this many facets of the surface. At most
/// this part of the border may be soft.
constexpr double kSoftBorder = 4, kAlikeArea = 4, kMaxSoft = 0.15;

/// The max distance of a claim's facets from its surface, as a multiple of the distance that the turns between them
/// explain. A multiple of 1 would be honest, but facets at the ends of a surface have too few neighbours to explain
/// themselves.
constexpr double kMaxUnexplained = 1.5;

/// A cone fits the corners of a sphere as well as the sphere does if its distance from them is larger by at most this
/// factor and this many tolerances.
constexpr double kAsNear = 2, kAsNearTolerances = 0.1;

/// The min number of corners of a claim that is believed. Each corner is a constraint.
std::size_t min_corners(SurfaceKind kind) {
  const auto parameters = static_cast<std::size_t>(parameter_count(kind));
  return kind == SurfaceKind::kTorus ? 2 * parameters : parameters + 4;
}

/// Returns whether the points lie on more circles around the axis of a torus than the number through which a torus
/// always passes.
bool has_enough_rings(std::span<const Vec3> points, const AnalyticSurface& torus, double tolerance,
                      const RunControl& control) {
  const Vec3 x = normalized(cross(torus.axis, std::fabs(torus.axis.x) < 0.8 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
  const Vec3 y = cross(torus.axis, x);
  std::vector<double> along_tube, around_tube;
  for (const Vec3& p : points) {
    const Vec3 q = p - torus.origin;
    const double z = dot(q, torus.axis), r = norm(q - z * torus.axis);
    around_tube.push_back(torus.minor_radius * std::atan2(z, r - torus.radius));
    along_tube.push_back(r * std::atan2(dot(q, y), dot(q, x)));
  }
  const auto count = [&](std::vector<double>& places) {
    sort_stoppable(places.begin(), places.end(), control);
    int circles = 1;
    for (std::size_t i = 1; i < places.size() && circles < kMinRings; ++i)
      if (places[i] - places[i - 1] > 4 * tolerance) ++circles;
    return circles;
  };
  return count(around_tube) >= kMinRings && count(along_tube) >= kMinRings - 2;
}

/// Returns whether a cylinder or a cone is as near to the corners of a sphere's facets as the sphere, which is so for a
/// single ring of facets: there is a sphere through any two circles about one axis.
/// Input: the corners.
bool is_ring(const FacetGraph& graph, const SurfaceClaim& sphere, std::span<const Vec3> points,
             const RunControl& control) {
  // A disc that closes a ring has its corners on the ring's circle, but the disc is no piece of the cone.
  constexpr std::size_t kMaxCorners = 4;
  std::vector<FacetPlace> places;
  for (const PatchId p : sphere.facets)
    if (graph.may_be_seed(p) && graph.corner_count(p) <= kMaxCorners)
      places.push_back({graph.mean_corner(p), graph.normal(p)});
  const double near =
      std::min(sphere.tolerance, std::max(kAsNear * sphere.deviation, kAsNearTolerances * sphere.tolerance));
  const auto fits_all = [&](const std::optional<AnalyticSurface>& guess) {
    const auto fitted = guess ? fit_from(*guess, points, {.control = &control}) : std::nullopt;
    return fitted && std::all_of(points.begin(), points.end(),
                                 [&](const Vec3& p) { return std::fabs(fitted->distance(p)) <= near; });
  };
  return fits_all(guess_cylinder(points, places)) || fits_all(guess_cone(points, places));
}

/// Removes facets whose corners are all at one height above a cone's apex, like a disc that closes it.
void drop_cross_sections(const FacetGraph& graph, const AnalyticSurface& cone, double tolerance,
                         std::vector<PatchId>& members) {
  std::erase_if(members, [&](PatchId p) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    graph.for_each_corner(p, [&](const Vec3& q) {
      low = std::min(low, dot(q, cone.axis));
      high = std::max(high, dot(q, cone.axis));
    });
    return high - low <= 2 * tolerance;
  });
}

}  // namespace

ClaimGrower::ClaimGrower(const FacetGraph& graph, RunControl& control)
    : graph_(graph), control_(control), check_(control), taken_(graph.size(), Taken::kFree), mark_(graph.size(), 0) {}

bool ClaimGrower::fits(const SurfaceGauge& gauge, PatchId p, double tolerance, int side) {
  work_ += kWorkOfTest;
  return is_on(graph_, gauge, p, tolerance, tolerance_, side);
}

double ClaimGrower::slack(std::size_t members) const {
  return std::min(first_slack_, members < 8 ? kFirstSlack : members < 32 ? 6 : members < 128 ? 2 : 1);
}

bool ClaimGrower::expand(const SurfaceGauge& gauge, double tolerance, int side, Taken may_replace, std::size_t max_size,
                         std::vector<PatchId>& members) {
  const std::size_t before = members.size();
  for (std::size_t i = 0; i < members.size() && members.size() < max_size; ++i)
    graph_.for_each_neighbour(members[i], [&](PatchId q) {
      check_();
      if (mark_[q] == growth_ || taken_[q] > may_replace || !graph_.may_be_curved(q)) return;
      if (!fits(gauge, q, tolerance, side)) return;
      mark_[q] = growth_;
      members.push_back(q);
    });
  return members.size() > before;
}

bool ClaimGrower::refit(AnalyticSurface& shape, std::span<const PatchId> members, Precision precision) {
  points_.clear();
  const std::size_t max_facets = precision == Precision::kExact ? kExactFitFacets : kFitFacets;
  const std::size_t step = (members.size() + max_facets - 1) / max_facets;
  for (std::size_t i = 0; i < members.size(); i += step)
    graph_.for_each_corner(members[i], [&](const Vec3& q) { points_.push_back(q); });
  const SurfaceGauge gauge(shape);
  double sum = 0;
  for (const Vec3& p : points_) {
    const double d = gauge.distance(p);
    sum += d * d;
  }
  const double good = precision == Precision::kExact ? 0 : kGoodEnough * tolerance_;
  if (sum <= static_cast<double>(points_.size()) * good * good) return true;
  // If a few facets do not fit, more facets will not fit either.
  const double hopeless = members.size() < kFewFacets ? tolerance_ : kFirstSlack * tolerance_;
  work_ += kWorkOfFit * points_.size();
  const std::optional<AnalyticSurface> better =
      fit_from(shape, points_, {.good = good, .hopeless = hopeless, .max_steps = kMaxFitSteps, .settled = kSettledFit});
  if (better) shape = *better;
  return better.has_value();
}

void ClaimGrower::trim(const AnalyticSurface& shape, double tolerance, int side, std::vector<PatchId>& members) {
  const SurfaceGauge gauge(shape);
  const auto leaves = [&](PatchId p) {
    check_();
    if (fits(gauge, p, tolerance, side)) return false;
    mark_[p] = 0;
    return true;
  };
  members.erase(std::remove_if(members.begin(), members.end(), leaves), members.end());
}

double ClaimGrower::turn(const SurfaceGauge& gauge, PatchId p) const {
  std::array<Vec3, 16> normals;
  std::size_t count = 0;
  double cosine = 1;
  graph_.for_each_corner(p, [&](const Vec3& q) {
    const Vec3 n = gauge.normal(q, tolerance_);
    if (norm_squared(n) == 0 || count == normals.size()) return;  // an apex has no normal
    for (std::size_t i = 0; i < count; ++i) cosine = std::min(cosine, dot(normals[i], n));
    normals[count++] = n;
  });
  return 1 - cosine;
}

double ClaimGrower::median_by_area(std::vector<std::pair<double, PatchId>>& values) const {
  sort_stoppable(values.begin(), values.end(), control_);
  double area = 0, below = 0;
  for (const auto& [value, p] : values) area += graph_.area(p);
  for (const auto& [value, p] : values) {
    below += graph_.area(p);
    if (2 * below >= area) return value;
  }
  return values.back().first;
}

double ClaimGrower::drop_uneven(const AnalyticSurface& shape, std::vector<PatchId>& members) {
  const SurfaceGauge gauge(shape);
  values_.clear();
  for (const PatchId p : members) values_.push_back({turn(gauge, p), p});
  double median = median_by_area(values_);
  // Strips over the whole length of a surface have one size. They may be compared by number.
  const auto strips =
      std::count_if(members.begin(), members.end(), [&](PatchId p) { return graph_.corner_count(p) == 4; });
  if (10 * static_cast<std::size_t>(strips) >= 9 * members.size())
    median = std::min(median, values_[values_.size() / 2].first);
  const double max = kMaxUneven * median;
  if (values_.back().first > max) {
    double area = 0, dropped = 0;
    for (const auto& [turn, p] : values_) (turn <= max ? area : dropped) += graph_.area(p);
    members.clear();
    // If such a large part is cut unevenly, all of it was meant to be flat.
    if (dropped > kMaxDropped * area) return 0;
    for (const auto& [turn, p] : values_)
      if (turn <= max) members.push_back(p);
  }
  double height = 0, area = 0;
  for (const PatchId p : members) {
    check_();
    height += graph_.area(p) * chord_height(graph_, gauge, p);
    area += graph_.area(p);
  }
  return area > 0 ? height / area : 0;
}

std::optional<SurfaceClaim> ClaimGrower::grow(const AnalyticSurface& start, std::span<const PatchId> seed,
                                              const ClaimGrowth& growth) {
  ++growth_;
  tolerance_ = growth.tolerance;
  is_doubtful_ = growth.is_doubtful;
  given_up_.clear();
  AnalyticSurface shape = start;
  const int side = side_of(graph_, SurfaceGauge(shape), seed);
  std::vector<PatchId> members;
  for (const PatchId p : seed) {
    if (!fits(SurfaceGauge(shape), p, kFirstSlack * tolerance_, side)) continue;
    mark_[p] = growth_;
    members.push_back(p);
  }
  if (members.size() < 2 || 2 * members.size() < seed.size()) return std::nullopt;
  first_slack_ = first_slack(chord_height(graph_, SurfaceGauge(shape), members.front()), tolerance_);
  std::optional<SurfaceClaim> claim;
  if (grow_members(shape, side, growth.may_replace, members)) claim = conclude(shape, side, members);
  if (!claim && members.size() >= min_facets(shape.kind)) given_up_ = std::move(members);
  return claim;
}

bool ClaimGrower::grow_members(AnalyticSurface& shape, int side, Taken may_replace, std::vector<PatchId>& members) {
  constexpr int kMaxRounds = 80;
  bool is_exact = false;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::size_t before = members.size();
    const double allowed = slack(before) * tolerance_;
    if (expand(SurfaceGauge(shape), allowed, side, may_replace, 2 * before + 2, members)) {
      if (!refit(shape, members, Precision::kGoodEnough)) return false;
      is_exact = false;
      trim(shape, slack(members.size()) * tolerance_, side, members);
      if (members.size() <= before) break;
    } else {
      // A better fit may let the claim grow further.
      if (is_exact) break;
      if (before < min_facets(shape.kind) || !refit(shape, members, Precision::kExact)) return false;
      is_exact = true;
    }
  }
  // The last rounds allow no slack.
  constexpr int kMaxLastRounds = 6;
  for (int round = 0; round < kMaxLastRounds; ++round) {
    const std::size_t before = members.size();
    trim(shape, tolerance_, side, members);
    const bool is_settled = members.size() == before;
    if (members.size() < min_facets(shape.kind)) return false;
    if (!expand(SurfaceGauge(shape), tolerance_, side, may_replace, static_cast<std::size_t>(-1), members) &&
        is_settled)
      break;
    if (!refit(shape, members, Precision::kExact)) return false;
  }
  return true;
}

bool ClaimGrower::goes_on_beyond(const SurfaceGauge& gauge, const SurfaceClaim& claim) {
  // Exactly the facets of the claim are marked.
  ++growth_;
  for (const PatchId p : claim.facets) mark_[p] = growth_;
  double border = 0, soft = 0;
  double area = 0;
  for (const PatchId p : claim.facets) area += graph_.area(p);
  const double alike = kAlikeArea * area / static_cast<double>(claim.facets.size());
  for (const PatchId p : claim.facets)
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
      check_();
      const PatchId q = graph_.beyond(s);
      if (q.is_valid() && mark_[q] == growth_) continue;
      const double length = norm(graph_.position(graph_.end_vertex(s)) - graph_.position(graph_.vertex(s)));
      border += length;
      // A ring has as many corners as the border has sides, and each side would need a test of all corners.
      if (!q.is_valid() || !graph_.may_be_seed(q)) continue;
      double distance = 0;
      graph_.for_each_corner(q, [&](const Vec3& c) { distance = std::max(distance, std::fabs(gauge.distance(c))); });
      if (distance <= kSoftBorder * claim.chord_height || graph_.area(q) <= alike) soft += length;
    }
  return soft > kMaxSoft * border;
}

bool ClaimGrower::is_explained(const SurfaceClaim& claim) const {
  double explained = 0, area = 0;
  for (const PatchId p : claim.facets) {
    if (!graph_.may_be_seed(p)) continue;
    explained += graph_.area(p) * explained_height(graph_, claim.shape, p);
    area += graph_.area(p);
  }
  return claim.chord_height * area <= kMaxUnexplained * explained + tolerance_ * area;
}

std::optional<SurfaceClaim> ClaimGrower::conclude(AnalyticSurface shape, int side, std::vector<PatchId> members) {
  constexpr int kMaxFits = 4;
  for (int i = 0; i < kMaxFits; ++i) {
    if (shape.kind == SurfaceKind::kCone) drop_cross_sections(graph_, shape, tolerance_, members);
    if (members.size() < min_facets(shape.kind)) return std::nullopt;
    const double height = drop_uneven(shape, members);
    if (members.size() < min_facets(shape.kind)) return std::nullopt;
    vertices_.clear();
    for (const PatchId p : members)
      for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s)
        if (graph_.is_corner(s)) vertices_.push_back(graph_.vertex(s));
    sort_unique(vertices_, control_);
    if (vertices_.size() < min_corners(shape.kind)) return std::nullopt;
    points_.clear();
    for (const VertexId v : vertices_) points_.push_back(graph_.position(v));
    // The sums of the fit come in an order that depends on the points alone.
    sort_stoppable(points_.begin(), points_.end(), control_);
    if (shape.kind == SurfaceKind::kTorus && !has_enough_rings(points_, shape, tolerance_, control_))
      return std::nullopt;
    work_ += (shape.kind == SurfaceKind::kSphere ? 4 : 2) * kWorkOfFit * points_.size();
    const std::optional<AnalyticSurface> near = fit_from(shape, points_, {.control = &control_});
    const auto best = near ? fit_from(*near, points_, {.is_canonical = true, .control = &control_}) : std::nullopt;
    if (!best) return std::nullopt;
    shape = *best;
    // A torus whose tube has its centre on the axis is a sphere.
    if (shape.kind == SurfaceKind::kTorus && !(std::fabs(shape.radius) > tolerance_)) return std::nullopt;
    const std::size_t before = members.size();
    trim(shape, tolerance_, side, members);
    if (members.size() == before) {
      SurfaceClaim claim{shape, side, std::move(members), tolerance_, {}, 0, 0, false, true, height, {}};
      claim.is_explained = is_explained(claim);
      const SurfaceGauge gauge(shape);
      std::size_t close = 0;
      for (const Vec3& p : points_) {
        const double d = std::fabs(gauge.distance(p));
        claim.deviation = std::max(claim.deviation, d);
        if (d <= kCloseClaim * tolerance_) ++close;
      }
      if (shape.kind == SurfaceKind::kSphere && claim.is_explained)
        claim.is_explained = !is_ring(graph_, claim, points_, control_);
      const double part = static_cast<double>(close) / static_cast<double>(points_.size());
      claim.is_clear = part >= kCloseOfFew;
      const bool is_clear = part >= (claim.facets.size() < kManyFacets ? kCloseOfFew : kCloseOfMany);
      if ((is_doubtful_ || !is_clear) && goes_on_beyond(gauge, claim)) return std::nullopt;
      for (const PatchId p : claim.facets) claim.area += graph_.area(p);
      return claim;
    }
  }
  return std::nullopt;
}

}  // namespace remesh
