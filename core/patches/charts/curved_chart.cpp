#include "core/patches/charts/curved_chart.h"

#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

/// Edges may exceed the allowed depth and turn by this factor, which covers rounding.
constexpr double kRoundingFactor = 1 + 1e-9;
bool is_doubly_curved(SurfaceKind kind) { return kind == SurfaceKind::kSphere || kind == SurfaceKind::kTorus; }

/// Returns the centre of a ball, or the point in the middle of a torus' tube that is nearest to a point.
Vec3 centre_beside(const AnalyticSurface& shape, const Vec3& p) {
  if (shape.kind == SurfaceKind::kSphere) return shape.origin;
  const Vec3 way = p - shape.origin;
  return shape.origin + shape.radius * normalized(way - dot(way, shape.axis) * shape.axis);
}

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

/// Returns where a segment is deepest below a cylinder, cone or ball, from 0 at a to 1 at b. On a line, the distance
/// from these surfaces is convex.
double deepest_place(const AnalyticSurface& shape, const Vec3& a, const Vec3& b) {
  const Vec3 from = a - shape.origin, way = b - a;
  // For a ball it is the place nearest to the centre. For a cylinder or cone, it is where the distance from the axis
  // has the slope of the surface.
  const double along = shape.kind == SurfaceKind::kSphere ? 0 : dot(way, shape.axis);
  const Vec3 across = way - along * shape.axis;
  const double square = norm_squared(across), foot = dot(from, across);
  if (!(square > 0)) return 0;
  double beyond = 0;
  if (shape.kind == SurfaceKind::kCone) {
    const double slope = along * std::tan(shape.half_angle), steepness = 1 - slope * slope / square;
    if (!(steepness > 0)) return slope > 0 ? 1 : 0;
    const Vec3 past = from - dot(from, shape.axis) * shape.axis - foot / square * across;
    beyond = slope * norm(past) / std::sqrt(steepness);
  }
  return std::clamp((beyond - foot) / square, 0.0, 1.0);
}

/// Returns the distance from a surface of the deepest place of a segment.
double largest_depth(const AnalyticSurface& shape, const Vec3& a, const Vec3& b, double at_a, double at_b) {
  if (shape.kind == SurfaceKind::kTorus) return highest_of_parabola(at_a, shape.distance(0.5 * (a + b)), at_b);
  const double t = deepest_place(shape, a, b);
  return std::max({std::fabs(at_a), std::fabs(at_b), std::fabs(shape.distance(a + t * (b - a)))});
}

}  // namespace

CurvedChart::CurvedChart(const CurvedPatch& patch)
    : map_(patch.map), max_height_(patch.limits.max_height * kRoundingFactor) {
  max_edge_height_ = is_doubly_curved(patch.map.shape().kind) ? kDepthOfEdges * max_height_ : max_height_;
  const double distance = 2 * std::sin(patch.limits.max_turn / 2) * kRoundingFactor;
  max_turn_squared_ = distance * distance;
  if (patch.map.shape().kind != SurfaceKind::kCone) return;
  // Faces at an apex that reached around the axis would be perpendicular to the surface. Faces turn by at most a third
  // of a circle, which changes the normals by the cosine of the half angle times the root of 3.
  const double cosine = std::cos(patch.map.shape().half_angle);
  max_turn_squared_at_apex_ = 3 * cosine * cosine;
  max_turn_squared_ = std::min(max_turn_squared_, max_turn_squared_at_apex_);
}

SpacePoint CurvedChart::space_point(const Vec3& position) const {
  const AnalyticSurface& shape = map_.shape();
  if (shape.kind != SurfaceKind::kCone) return {position, map_.side() * shape.normal(position)};
  const double radius = map_.radius(position);
  constexpr double kAtApex = 1e-3;
  if (radius < kAtApex * max_edge_height_) return {position, {}, true};
  // At this distance from its apex, a cone is within the tolerance of edges that turn by a sixth of a circle. Still
  // nearer, it is within the tolerance of edges that turn by a third.
  constexpr double kHeightOfSixth = 0.134, kHeightOfThird = 0.5;
  const double depth = radius * std::cos(shape.half_angle);
  return {position, map_.side() * shape.normal(position), kHeightOfSixth * depth < max_edge_height_,
          kHeightOfThird * depth < max_edge_height_};
}

bool CurvedChart::is_bent(const SpacePoint& a, const SpacePoint& b) const {
  const bool is_at_apex = a.normal == Vec3{} || b.normal == Vec3{};
  double max_squared = max_turn_squared_;
  // Two normals that are 60 degrees apart differ by 1.
  if (a.is_near_apex || b.is_near_apex) max_squared = std::max(max_squared, std::min(1.0, max_turn_squared_at_apex_));
  if (a.is_beside_apex || b.is_beside_apex) max_squared = max_turn_squared_at_apex_;
  if (!is_at_apex && norm_squared(a.normal - b.normal) > max_squared) return true;
  const AnalyticSurface& shape = map_.shape();
  const double at_a = shape.distance(a.position), at_b = shape.distance(b.position);
  // Some straight boundaries are deeper than the limit. Smaller edges at a vertex of such a boundary would be as deep.
  const double at_ends = std::max(std::fabs(at_a), std::fabs(at_b));
  const double limit = std::max(max_edge_height_, at_ends * kRoundingFactor);
  return largest_depth(shape, a.position, b.position, at_a, at_b) > limit;
}

bool CurvedChart::is_deep(const Vec3& a, const Vec3& b, const Vec3& c) const {
  const AnalyticSurface& shape = map_.shape();
  if (!is_doubly_curved(shape.kind)) return false;
  const auto is_far = [&](const Vec3& p) { return std::fabs(shape.distance(p)) > max_height_; };
  const Vec3 middle = (1.0 / 3) * (a + b + c);
  for (const Vec3& start : {middle, 0.5 * (middle + a), 0.5 * (middle + b), 0.5 * (middle + c)}) {
    if (is_far(start)) return true;
    // The deepest place is the one nearest to the centre of the ball, or to that of the tube next to it.
    Vec3 deepest = start;
    for (int i = 0; i < 2; ++i) deepest = nearest_on_triangle(centre_beside(shape, deepest), {a, b, c});
    if (is_far(deepest)) return true;
    if (shape.kind == SurfaceKind::kSphere) break;
  }
  return false;
}

}  // namespace remesh
