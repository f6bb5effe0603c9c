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

/// Two facets with a common edge, and the facets around them. Places are seen from the start of the edge.
class FacetPair {
 public:
  /// Output: nothing if there are many facets around the two.
  static std::optional<FacetPair> of(const FacetGraph& graph, const SurfaceSeed& seed) {
    FacetPair pair(graph, graph.vertex(seed.side), graph.vertex(seed.end_side));
    const std::array<PatchId, 2> facets{seed.facet, graph.beyond(seed.side)};
    for (std::size_t i = 0; i < 2; ++i) {
      pair.take_apex(i, facets[i]);
      if (graph.corner_count(facets[i]) > 3) pair.add_around(facets[i], pair.polygons_, pair.polygon_count_);
      for (std::uint32_t s = graph.sides_begin(facets[i]); s < graph.sides_end(facets[i]); ++s) {
        const PatchId q = graph.beyond(s);
        if (!q.is_valid() || q == facets[1 - i] || !graph.may_be_curved(q)) continue;
        if (!pair.add_around(q, pair.around_, pair.around_count_)) return std::nullopt;
      }
    }
    return pair;
  }

  bool has_polygon() const { return polygon_count_ > 0; }

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

  /// The edge is a ruling, and the apex is where it meets the next ones.
  bool has_cone(double allowed) const {
    const ConeApexes apexes = guess_apexes(corners(0), corners(1), {}, edge_);
    for (std::size_t i = 0; i < apexes.count; ++i)
      if (has_cone_at(apexes.at[i], allowed)) return true;
    return false;
  }

 private:
  bool has_cone_at(double t, double allowed) const {
    const Vec3 apex = t * edge_;
    const Vec3 u = normalized((t < 0.5 ? edge_ : Vec3{}) - apex);
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

  FacetPair(const FacetGraph& graph, VertexId start, VertexId end)
      : graph_(graph), start_(start), end_(end), origin_(graph.position(start)), edge_(graph.position(end) - origin_) {}

  std::span<const Vec3> corners(std::size_t i) const { return std::span(corners_[i]).first(corner_count_[i]); }

  /// Takes the corner that is farthest from the edge, as the guesses do, and all corners if they are few.
  void take_apex(std::size_t i, PatchId p) {
    double farthest = -1;
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
      const VertexId v = graph_.vertex(s);
      if (!graph_.is_corner(s)) continue;
      const Vec3 way = graph_.position(v) - origin_;
      if (graph_.corner_count(p) <= kMaxOfGuess) corners_[i][corner_count_[i]++] = way;
      if (v == start_ || v == end_) continue;
      const double distance = norm_squared(cross(way, edge_));
      if (!(distance > farthest)) continue;
      farthest = distance;
      apexes_[i] = v;
      apex_[i] = way;
    }
  }

  template <std::size_t Max>
  bool add_around(PatchId q, std::array<PatchId, Max>& facets, std::size_t& count) {
    if (count == Max) return false;
    facets[count++] = q;
    return true;
  }

  /// Returns the bound on the difference of squares, |q - centre|^2 - radius^2, for points that are near a circle or a
  /// sphere.
  static double bound(double radius, double allowed) { return allowed * (2 * radius + allowed); }

  /// A measure that is no number proves nothing.
  template <class Measure>
  bool is_near(PatchId p, const Measure& measure, double bound) const {
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
      const VertexId v = graph_.vertex(s);
      if (!graph_.is_corner(s) || v == start_ || v == end_ || v == apexes_[0] || v == apexes_[1]) continue;
      if (std::fabs(measure(graph_.position(v) - origin_)) > bound) return false;
    }
    return true;
  }

  template <class Measure>
  bool are_enough(const Measure& measure, double bound) const {
    for (std::size_t i = 0; i < polygon_count_; ++i)
      if (!is_near(polygons_[i], measure, bound)) return false;
    // At the end of a strip of polygons there is one neighbour, behind which the next one may be.
    const std::size_t wanted = has_polygon() ? std::min(kMinNeighbours, around_count_) : kMinNeighbours;
    std::size_t near = 0;
    for (std::size_t i = 0; i < around_count_ && near < wanted; ++i)
      if (is_near(around_[i], measure, bound)) ++near;
    return near >= wanted;
  }

  const FacetGraph& graph_;
  VertexId start_, end_;
  static constexpr std::size_t kMaxOfGuess = 4;
  std::array<VertexId, 2> apexes_;
  std::array<std::array<Vec3, kMaxOfGuess>, 2> corners_;
  std::array<std::size_t, 2> corner_count_{};
  Vec3 origin_, edge_;
  std::array<Vec3, 2> apex_;
  std::array<PatchId, 2> polygons_;
  std::array<PatchId, 16> around_;
  std::size_t polygon_count_ = 0, around_count_ = 0;
};

}  // namespace

SurfaceKinds kinds_that_may_begin(const FacetGraph& graph, const SurfaceSeed& seed, double tolerance) {
  const std::optional<FacetPair> pair = FacetPair::of(graph, seed);
  if (!pair) return SurfaceKinds::all();
  // Of more than four corners, the guess is a mean.
  const double twice = 2 * kFirstSlack * tolerance, wide = (pair->has_polygon() ? 2 : 1) * twice;
  SurfaceKinds kinds = SurfaceKinds::none();
  if (pair->has_sphere(wide)) kinds.add(SurfaceKind::kSphere);
  if (pair->has_cylinder(twice)) kinds.add(SurfaceKind::kCylinder);
  if (pair->has_cone(wide)) kinds.add(SurfaceKind::kCone);
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
