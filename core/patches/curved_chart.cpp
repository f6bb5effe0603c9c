#include "core/patches/curved_chart.h"

#include <algorithm>
#include <cmath>

namespace remesh {
namespace {

/// Edges may be a little deeper, and turn a little more, than is allowed: rounding alone makes as much difference.
constexpr double kRoundingFactor = 1 + 1e-9;
/// A triangle of a ball is deeper in its middle than at its edges. With acute angles, its circumradius is at most its
/// longest edge over the root of 3, instead of half of that edge, so its depth is at most 4/3 of that of its edges.
constexpr double kDepthOfEdges = 0.75;

/// Returns the largest absolute value that a parabola takes between 0 and 1.
double highest_of_parabola(double at_0, double at_half, double at_1) {
  double highest = std::max({std::fabs(at_0), std::fabs(at_half), std::fabs(at_1)});
  const double bend = 2 * (at_0 - 2 * at_half + at_1), slope = 4 * at_half - 3 * at_0 - at_1;
  if (bend != 0) {
    const double t = -slope / (2 * bend);
    if (t > 0 && t < 1) highest = std::max(highest, std::fabs(at_0 + t * (slope + t * bend)));
  }
  return highest;
}

}  // namespace

CurvedChart::CurvedChart(const CurvedPatch& patch)
    : map_(patch.map), max_height_(patch.limits.max_height * kRoundingFactor) {
  const SurfaceKind kind = patch.map.shape().kind;
  if (kind == SurfaceKind::kSphere || kind == SurfaceKind::kTorus) max_height_ *= kDepthOfEdges;
  const double distance = 2 * std::sin(patch.limits.max_turn / 2) * kRoundingFactor;
  max_turn_squared_ = distance * distance;
}

SpacePoint CurvedChart::space_point(const Vec3& position) const {
  const AnalyticSurface& shape = map_.shape();
  if (shape.kind != SurfaceKind::kCone) return {position, map_.side() * shape.normal(position)};
  const double radius = map_.radius(position);
  constexpr double kAtApex = 1e-3;
  if (radius < kAtApex * max_height_) return {position, {}, true};
  // So near to its apex, a cone is within the tolerance of edges that turn by a sixth of a circle.
  constexpr double kHeightOfSixth = 0.134;
  const bool is_near_apex = radius * kHeightOfSixth * std::cos(shape.half_angle) < max_height_;
  return {position, map_.side() * shape.normal(position), is_near_apex};
}

bool CurvedChart::is_bent(const SpacePoint& a, const SpacePoint& b) const {
  const bool is_at_apex = a.normal == Vec3{} || b.normal == Vec3{};
  // Two normals that are 60 degrees apart differ by 1.
  const double max_squared = a.is_near_apex || b.is_near_apex ? std::max(max_turn_squared_, 1.0) : max_turn_squared_;
  if (!is_at_apex && norm_squared(a.normal - b.normal) > max_squared) return true;
  const AnalyticSurface& shape = map_.shape();
  const double at_a = shape.distance(a.position), at_b = shape.distance(b.position);
  // Some boundaries are straight and deeper than that. Smaller edges at a vertex of them would be as deep.
  const double at_ends = std::max(std::fabs(at_a), std::fabs(at_b));
  const double limit = std::max(max_height_, at_ends * kRoundingFactor);
  return highest_of_parabola(at_a, shape.distance(0.5 * (a.position + b.position)), at_b) > limit;
}

}  // namespace remesh
