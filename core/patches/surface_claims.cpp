#include "core/patches/surface_claims.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace remesh {
namespace {

/// A few facets determine a surface badly, so far corners may be off by this many tolerances until more are found.
constexpr double kFirstSlack = 20;

/// The surface is fitted to at most this many facets while it grows, evenly chosen.
constexpr std::size_t kFitFacets = 64;

/// The angle between the normals of a facet and of its surface in the facet's middle is at most acos of this. Facets
/// that meet smoothly turn by half the feature angle.
constexpr double kMinFacing = 0.8;

/// A facet whose chord height is larger than this many medians was cut on purpose: it is the flat on a shaft.
constexpr double kMaxUneven = 3;

/// A torus through three circles about one axis proves nothing, because there always is one.
constexpr int kMinRings = 4;

/// The smallest numbers of facets that are believed.
std::size_t min_facets(SurfaceKind kind) { return kind == SurfaceKind::kTorus ? 6 : 4; }

/// The number of corners that are believed. Each is a constraint.
std::size_t min_corners(SurfaceKind kind) {
  const auto parameters = static_cast<std::size_t>(parameter_count(kind));
  return kind == SurfaceKind::kTorus ? 2 * parameters : parameters + 4;
}

double slack_of(std::size_t members) { return members < 8 ? kFirstSlack : members < 32 ? 6 : members < 128 ? 2 : 1; }

}  // namespace

class ClaimGrower::Gauge {
 public:
  explicit Gauge(const AnalyticSurface& s)
      : kind_(s.kind),
        origin_(s.origin),
        axis_(s.axis),
        radius_(s.radius),
        minor_radius_(s.minor_radius),
        cosine_(std::cos(s.half_angle)),
        sine_(std::sin(s.half_angle)) {}

  SurfaceKind kind() const { return kind_; }

  double distance(const Vec3& p) const {
    const Vec3 q = p - origin_;
    if (kind_ == SurfaceKind::kSphere) return std::sqrt(norm_squared(q)) - radius_;
    const double z = dot(q, axis_);
    const double r = std::sqrt(norm_squared(q - z * axis_));
    if (kind_ == SurfaceKind::kCylinder) return r - radius_;
    if (kind_ == SurfaceKind::kCone) return r * cosine_ - z * sine_;
    const double u = r - radius_;
    return std::sqrt(u * u + z * z) - minor_radius_;
  }

  /// Returns the cosine of the angle between a direction and the surface's normal at a place near it.
  double facing(const Vec3& p, const Vec3& direction) const {
    const Vec3 q = p - origin_;
    if (kind_ == SurfaceKind::kSphere) return dot(q, direction) / std::sqrt(norm_squared(q));
    const double z = dot(q, axis_);
    const Vec3 w = q - z * axis_;
    const double r = std::sqrt(norm_squared(w)), outwards = dot(w, direction) / r, along = dot(axis_, direction);
    if (kind_ == SurfaceKind::kCylinder) return outwards;
    if (kind_ == SurfaceKind::kCone) return outwards * cosine_ - along * sine_;
    const double u = r - radius_;
    return (u * outwards + z * along) / std::sqrt(u * u + z * z);
  }

 private:
  SurfaceKind kind_;
  Vec3 origin_, axis_;
  double radius_, minor_radius_, cosine_, sine_;
};

ClaimGrower::ClaimGrower(const FacetGraph& graph, double tolerance, RunControl& control)
    : graph_(graph),
      tolerance_(tolerance),
      check_(control),
      taken_(graph.size(), Taken::kFree),
      mark_(graph.size(), 0) {}

FacetPlace ClaimGrower::place_of(PatchId p) const {
  Vec3 sum;
  int count = 0;
  graph_.for_each_corner(p, [&](const Vec3& q) {
    sum += q;
    ++count;
  });
  return {(1.0 / std::max(1, count)) * sum, graph_.normal(p)};
}

bool ClaimGrower::fits(const Gauge& gauge, PatchId p, double tolerance, int side) const {
  Vec3 sum;
  int count = 0;
  for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
    if (!graph_.is_corner(s)) continue;
    const Vec3& q = graph_.position(graph_.vertex(s));
    if (!(std::fabs(gauge.distance(q)) <= tolerance)) return false;
    // Two circles lie on a cylinder, but also on a sphere, to which the facets between them are no tangents.
    if (!(side * gauge.facing(q, graph_.normal(p)) >= kMinFacing)) return false;
    sum += q;
    ++count;
  }
  const double facing = side * gauge.facing((1.0 / count) * sum, graph_.normal(p));
  return facing >= kMinFacing;
}

double ClaimGrower::chord_height(const Gauge& gauge, PatchId p) const {
  Vec3 sum, first, last;
  int count = 0;
  double height = 0;
  graph_.for_each_corner(p, [&](const Vec3& q) {
    if (count == 0)
      first = q;
    else
      height = std::max(height, std::fabs(gauge.distance(0.5 * (last + q))));
    last = q;
    sum += q;
    ++count;
  });
  height = std::max(height, std::fabs(gauge.distance(0.5 * (last + first))));
  return std::max(height, std::fabs(gauge.distance((1.0 / count) * sum)));
}

bool ClaimGrower::expand(const Gauge& gauge, double tolerance, int side, Taken may_replace, std::size_t max_size,
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

bool ClaimGrower::refit(AnalyticSurface& shape, std::span<const PatchId> members) {
  points_.clear();
  const std::size_t step = (members.size() + kFitFacets - 1) / kFitFacets;
  for (std::size_t i = 0; i < members.size(); i += step)
    graph_.for_each_corner(members[i], [&](const Vec3& q) { points_.push_back(q); });
  const Gauge gauge(shape);
  double sum = 0;
  for (const Vec3& p : points_) {
    const double d = gauge.distance(p);
    sum += d * d;
  }
  // The exact fit comes last.
  constexpr double kGoodEnough = 0.2;
  const double good = kGoodEnough * tolerance_;
  if (sum <= static_cast<double>(points_.size()) * good * good) return true;
  const std::optional<AnalyticSurface> better = fit_from(shape, points_, {good, kFirstSlack * tolerance_});
  if (better) shape = *better;
  return better.has_value();
}

void ClaimGrower::trim(const AnalyticSurface& shape, double tolerance, int side, std::vector<PatchId>& members) {
  const Gauge gauge(shape);
  const auto leaves = [&](PatchId p) {
    check_();
    if (fits(gauge, p, tolerance, side)) return false;
    mark_[p] = 0;
    return true;
  };
  members.erase(std::remove_if(members.begin(), members.end(), leaves), members.end());
}

double ClaimGrower::drop_uneven(const AnalyticSurface& shape, std::vector<PatchId>& members) const {
  const Gauge gauge(shape);
  std::vector<std::pair<double, PatchId>> heights;
  heights.reserve(members.size());
  double area = 0;
  for (const PatchId p : members) {
    heights.push_back({chord_height(gauge, p), p});
    area += graph_.area(p);
  }
  std::sort(heights.begin(), heights.end());
  double below = 0, median = 0;
  for (const auto& [height, p] : heights) {
    below += graph_.area(p);
    median = height;
    if (2 * below >= area) break;
  }
  const double max = kMaxUneven * median + tolerance_;
  if (heights.back().first <= max) return median;
  members.clear();
  for (const auto& [height, p] : heights)
    if (height <= max) members.push_back(p);
  return median;
}

bool ClaimGrower::has_enough_rings(const AnalyticSurface& torus, double tolerance) const {
  std::vector<double> places;
  for (const Vec3& p : points_) {
    const Vec3 q = p - torus.origin;
    const double z = dot(q, torus.axis), r = norm(q - z * torus.axis);
    places.push_back(torus.minor_radius * std::atan2(z, r - torus.radius));
  }
  std::sort(places.begin(), places.end());
  int rings = 1;
  for (std::size_t i = 1; i < places.size() && rings < kMinRings; ++i)
    if (places[i] - places[i - 1] > 4 * tolerance) ++rings;
  return rings >= kMinRings;
}

std::optional<Claim> ClaimGrower::grow(const AnalyticSurface& start, std::span<const PatchId> seed, Taken may_replace) {
  ++growth_;
  Claim claim;
  AnalyticSurface shape = start;
  double facing = 0;
  {
    const Gauge gauge(shape);
    for (const PatchId p : seed) {
      const FacetPlace at = place_of(p);
      facing += gauge.facing(at.middle, at.normal);
    }
  }
  const int side = facing >= 0 ? 1 : -1;
  std::vector<PatchId> members;
  for (const PatchId p : seed) {
    if (!fits(Gauge(shape), p, kFirstSlack * tolerance_, side)) continue;
    mark_[p] = growth_;
    members.push_back(p);
  }
  if (members.size() < 2 || 2 * members.size() < seed.size()) return std::nullopt;
  constexpr int kMaxRounds = 60;
  for (int round = 0; round < kMaxRounds; ++round) {
    const std::size_t before = members.size();
    const double tolerance = slack_of(before) * tolerance_;
    const bool has_grown = expand(Gauge(shape), tolerance, side, may_replace, 2 * before + 2, members);
    if (!has_grown && before < min_facets(shape.kind)) return std::nullopt;
    if (has_grown) {
      if (!refit(shape, members)) return std::nullopt;
      trim(shape, slack_of(members.size()) * tolerance_, side, members);
      if (members.size() > before) continue;
    }
    break;
  }
  // The last rounds have no slack.
  constexpr int kMaxLastRounds = 6;
  for (int round = 0; round < kMaxLastRounds; ++round) {
    if (!refit(shape, members)) return std::nullopt;
    const std::size_t before = members.size();
    trim(shape, tolerance_, side, members);
    const bool is_settled = members.size() == before;
    if (members.size() < min_facets(shape.kind)) return std::nullopt;
    if (!expand(Gauge(shape), tolerance_, side, may_replace, static_cast<std::size_t>(-1), members) && is_settled)
      break;
  }
  return conclude(shape, side, std::move(members));
}

std::optional<Claim> ClaimGrower::conclude(AnalyticSurface shape, int side, std::vector<PatchId> members) {
  constexpr int kMaxFits = 4;
  for (int i = 0; i < kMaxFits; ++i) {
    const double chord_height = drop_uneven(shape, members);
    if (members.size() < min_facets(shape.kind)) return std::nullopt;
    vertices_.clear();
    for (const PatchId p : members)
      for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s)
        if (graph_.is_corner(s)) vertices_.push_back(graph_.vertex(s));
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    if (vertices_.size() < min_corners(shape.kind)) return std::nullopt;
    points_.clear();
    for (const VertexId v : vertices_) points_.push_back(graph_.position(v));
    // The sums of the fit come in an order that depends on the points alone.
    std::sort(points_.begin(), points_.end());
    const std::optional<AnalyticSurface> best = fit_from(shape, points_);
    if (!best) return std::nullopt;
    shape = *best;
    const std::size_t before = members.size();
    trim(shape, tolerance_, side, members);
    if (members.size() == before) {
      if (shape.kind == SurfaceKind::kTorus && !has_enough_rings(shape, tolerance_)) return std::nullopt;
      Claim claim{shape, side, std::move(members), 0, 0, chord_height};
      const Gauge gauge(shape);
      for (const Vec3& p : points_) claim.deviation = std::max(claim.deviation, std::fabs(gauge.distance(p)));
      for (const PatchId p : claim.facets) claim.area += graph_.area(p);
      return claim;
    }
  }
  return std::nullopt;
}

}  // namespace remesh
