#include "core/patches/recognition/explained_height.h"

#include <algorithm>
#include <cmath>

namespace remesh {
namespace {

/// If a facet turns in one direction by less than this part of its turn in the opposite direction, the smaller one
/// counts as no turn.
constexpr double kNoTurn = 0.2;

/// A corner is an apex if its distance from the axis is below this part of the other corners' distance.
constexpr double kNearApex = 0.02;

double angle_of(double sine) { return std::asin(std::clamp(sine, -1.0, 1.0)); }

/// Returns the largest distance of a facet's corners from the line through a side.
double width_beside(const FacetGraph& graph, PatchId p, const Vec3& start, const Vec3& direction) {
  double width = 0;
  graph.for_each_corner(p, [&](const Vec3& q) {
    const Vec3 way = q - start;
    width = std::max(width, norm_squared(way - dot(way, direction) * direction));
  });
  return std::sqrt(width);
}

/// The extent of a facet in one direction along its surface.
struct Span {
  double low = HUGE_VAL, high = -HUGE_VAL;
  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double length() const { return high > low ? high - low : 0; }
};

bool share_corner(const FacetGraph& graph, PatchId p, PatchId q) {
  bool is_shared = false;
  for (std::uint32_t s = graph.sides_begin(p); s < graph.sides_end(p); ++s)
    for (std::uint32_t t = graph.sides_begin(q); t < graph.sides_end(q) && graph.is_corner(s) && !is_shared; ++t)
      is_shared = graph.vertex(s) == graph.vertex(t);
  return is_shared;
}

/// Returns the part of explained_height in one direction.
double height_along(const FacetGraph& graph, const AnalyticSurface& shape, PatchId p, const Vec3& direction) {
  Span width, turn;
  double farthest = 0;
  graph.for_each_corner(p, [&](const Vec3& q) { farthest = std::max(farthest, shape.distance_from_axis(q)); });
  graph.for_each_corner(p, [&](const Vec3& q) {
    width.add(dot(q, direction));
    // In an apex, the direction of the normal is mere rounding.
    if (shape.distance_from_axis(q) > kNearApex * farthest) turn.add(angle_of(dot(shape.normal(q), direction)));
  });
  const double own = dot(graph.normal(p), direction);
  double before = 0, behind = 0;
  const auto add = [&](PatchId q) {
    const double sine = dot(graph.normal(q), direction) - own;
    before = std::max(before, sine);
    behind = std::max(behind, -sine);
  };
  graph.for_each_neighbour(p, [&](PatchId q) {
    add(q);
    // The neighbours of a triangle may be the other halves of pieces of the surface. The next pieces share a corner.
    if (graph.corner_count(p) == 3)
      graph.for_each_neighbour(q, [&](PatchId r) {
        if (r != p && share_corner(graph, p, r)) add(r);
      });
  });
  before = angle_of(before);
  behind = angle_of(behind);
  const double more = std::max(before, behind);
  const double allowed = std::min(before, behind) > kNoTurn * more ? before + behind : 2 * more;
  const double span = turn.length();
  if (!(span > 0) || !(allowed > 0)) return 0;
  const double radius = width.length() / (2 * std::sin(span / 2)), counted = std::min(span, allowed);
  const double sine = std::sin(counted / 4);
  return radius * 2 * sine * sine;
}

/// Returns the direction along a sphere in which a facet turns most against a neighbour. It is null if the facet turns
/// against none.
Vec3 direction_of_turn(const FacetGraph& graph, PatchId p) {
  const Vec3& normal = graph.normal(p);
  Vec3 strongest;
  graph.for_each_neighbour(p, [&](PatchId q) {
    const Vec3 turn = graph.normal(q) - dot(graph.normal(q), normal) * normal;
    const double more = norm_squared(turn) - norm_squared(strongest);
    if (more > 0 || (more == 0 && turn < strongest)) strongest = turn;
  });
  return normalized(strongest);
}

}  // namespace

double implied_chord_height(const FacetGraph& graph, PatchId p, std::uint32_t side) {
  const PatchId q = graph.beyond(side);
  const Vec3& start = graph.position(graph.vertex(side));
  const Vec3 direction = normalized(graph.position(graph.end_vertex(side)) - start);
  const Vec3 &n = graph.normal(p), &m = graph.normal(q);
  const double turn = std::atan2(norm(cross(n, m)), dot(n, m));
  const double width = std::min(width_beside(graph, p, start, direction), width_beside(graph, q, start, direction));
  return width / 2 * std::tan(turn / 4);
}

double explained_height(const FacetGraph& graph, const AnalyticSurface& shape, PatchId p) {
  if (shape.kind == SurfaceKind::kSphere) {
    const Vec3 along = direction_of_turn(graph, p);
    return height_along(graph, shape, p, along) +
           height_along(graph, shape, p, normalized(cross(graph.normal(p), along)));
  }
  const Vec3 around = normalized(cross(shape.axis, graph.mean_corner(p) - shape.origin));
  double height = height_along(graph, shape, p, around);
  if (shape.kind == SurfaceKind::kTorus)
    height += height_along(graph, shape, p, normalized(cross(graph.normal(p), around)));
  return height;
}

}  // namespace remesh
