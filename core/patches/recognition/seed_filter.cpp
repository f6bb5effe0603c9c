#include "core/patches/recognition/seed_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace remesh {
namespace {

/// A surface is believed only with this many facets besides the first two.
constexpr std::size_t kMinNeighbours = 2;

/// Two triangles with a common edge, from its start: the end of the edge, the other corners of both triangles, and the
/// far corners of their neighbours.
class TrianglePair {
 public:
  /// Output: nothing if some facet is no triangle.
  static std::optional<TrianglePair> of(const FacetGraph& graph, const SurfaceSeed& seed) {
    TrianglePair pair;
    const Vec3 &a = graph.position(graph.vertex(seed.side)), &b = graph.position(graph.vertex(seed.end_side));
    pair.edge_ = b - a;
    const std::array<PatchId, 2> facets{seed.facet, graph.beyond(seed.side)};
    for (std::size_t i = 0; i < 2; ++i) {
      if (!is_triangle(graph, facets[i])) return std::nullopt;
      for (std::uint32_t s = graph.sides_begin(facets[i]); s < graph.sides_end(facets[i]); ++s) {
        const Vec3 &from = graph.position(graph.vertex(s)), &to = graph.position(graph.end_vertex(s));
        if (from != a && from != b) pair.apex_[i] = from - a;
        const PatchId q = graph.beyond(s);
        if (!q.is_valid() || q == facets[1 - i]) continue;
        if (!is_triangle(graph, q)) return std::nullopt;
        for (std::uint32_t t = graph.sides_begin(q); t < graph.sides_end(q); ++t)
          if (const Vec3& far = graph.position(graph.vertex(t)); far != from && far != to)
            pair.far_[pair.far_count_++] = far - a;
      }
    }
    return pair;
  }

  bool has_sphere(double allowed) const {
    const Vec3 &u = edge_, &v = apex_[0], &w = apex_[1];
    const Vec3 vw = cross(v, w), wu = cross(w, u), uv = cross(u, v);
    const double volume = 2 * dot(u, vw);
    const Vec3 centre = (1 / volume) * (norm_squared(u) * vw + norm_squared(v) * wu + norm_squared(w) * uv);
    return are_enough([&](const Vec3& q) { return norm_squared(q) - 2 * dot(q, centre); },
                      bound(std::sqrt(norm_squared(centre)), allowed));
  }

  /// The edge is a ruling.
  bool has_cylinder(double allowed) const {
    const double length = 1 / norm_squared(edge_);
    const auto across = [&](const Vec3& q) { return q - length * dot(q, edge_) * edge_; };
    const Vec3 v = across(apex_[0]), w = across(apex_[1]), n = cross(v, w);
    const Vec3 centre = (0.5 / norm_squared(n)) * (norm_squared(w) * cross(n, v) + norm_squared(v) * cross(w, n));
    return are_enough(
        [&](const Vec3& far) {
          const Vec3 q = across(far);
          return norm_squared(q) - 2 * dot(q, centre);
        },
        bound(std::sqrt(norm_squared(centre)), allowed));
  }

  /// The edge is a ruling, and the apex is one of its ends.
  bool has_cone(bool is_at_end, double allowed) const {
    const Vec3 apex = is_at_end ? edge_ : Vec3{};
    const Vec3 u = normalized(is_at_end ? -edge_ : edge_);
    const Vec3 v = normalized(apex_[0] - apex), w = normalized(apex_[1] - apex);
    Vec3 axis = normalized(cross(v - u, w - u));
    if (dot(axis, u) < 0) axis = -axis;
    const double cosine = dot(axis, u), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
    return are_enough(
        [&](const Vec3& far) {
          const Vec3 q = far - apex;
          const double z = dot(q, axis);
          return std::sqrt(std::max(0.0, norm_squared(q) - z * z)) * cosine - z * sine;
        },
        allowed);
  }

 private:
  static bool is_triangle(const FacetGraph& graph, PatchId p) {
    return graph.may_be_seed(p) && graph.corner_count(p) == 3 && graph.sides_end(p) - graph.sides_begin(p) == 3;
  }

  /// Returns the bound on the difference of squares, |q - centre|^2 - radius^2, for points that are near a circle or a
  /// sphere.
  static double bound(double radius, double allowed) { return allowed * (2 * radius + allowed); }

  template <class Measure>
  bool are_enough(const Measure& measure, double bound) const {
    std::size_t near = 0;
    // A measure that is no number proves nothing.
    for (std::size_t i = 0; i < far_count_; ++i)
      if (!(std::fabs(measure(far_[i])) > bound)) ++near;
    return near >= kMinNeighbours;
  }

  Vec3 edge_;
  std::array<Vec3, 2> apex_;
  std::array<Vec3, 4> far_;
  std::size_t far_count_ = 0;
};

}  // namespace

SurfaceKinds kinds_that_may_begin(const FacetGraph& graph, const SurfaceSeed& seed, double tolerance) {
  const std::optional<TrianglePair> pair = TrianglePair::of(graph, seed);
  if (!pair) return SurfaceKinds::all();
  const double twice = 2 * kFirstSlack * tolerance;
  SurfaceKinds kinds = SurfaceKinds::none();
  if (pair->has_sphere(twice)) kinds.add(SurfaceKind::kSphere);
  if (pair->has_cylinder(twice)) kinds.add(SurfaceKind::kCylinder);
  if (pair->has_cone(false, twice) || pair->has_cone(true, twice)) kinds.add(SurfaceKind::kCone);
  return kinds;
}

bool may_grow(const FacetGraph& graph, const AnalyticSurface& start, std::span<const PatchId> pair, double tolerance) {
  const SurfaceGauge gauge(start);
  const int side = side_of(graph, gauge, pair);
  for (const PatchId p : pair)
    if (!is_on(graph, gauge, p, kFirstSlack * tolerance, tolerance, side)) return false;
  const double allowed = first_slack(chord_height(graph, gauge, pair.front()), tolerance) * tolerance;
  const std::size_t enough = min_facets(start.kind);
  std::array<PatchId, kMinFacetsOfTorus> members;
  std::size_t count = 0;
  for (const PatchId p : pair) members[count++] = p;
  for (std::size_t i = 0; i < count && count < enough; ++i)
    graph.for_each_neighbour(members[i], [&](PatchId q) {
      if (count == enough || std::find(members.begin(), members.begin() + count, q) != members.begin() + count) return;
      if (graph.may_be_curved(q) && is_on(graph, gauge, q, allowed, tolerance, side)) members[count++] = q;
    });
  return count == enough;
}

}  // namespace remesh
