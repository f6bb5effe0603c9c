#include "core/refinement/edge_sizes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/stoppable.h"
#include "core/refinement/strips.h"

namespace remesh {
namespace {

using Mesh = Triangulation2d;

/// See experiments.md, Prediction, for these numbers. At a bound of kHopelessDeg, refinement would not end. How fast
/// lengths may grow falls with the fourth power of the bound over it.
constexpr double kHopelessDeg = 36;
/// This is how much lengths grow per distance without a bound.
constexpr double kGrowth = 1.1;
/// An edge between two vertices inside a patch asks for so many times its length, without a bound.
constexpr double kInside = 1.9;
/// Beside a vertex, pieces are so many times as long as would fit, without a bound: they end in other places.
constexpr double kBesideVertex = 0.95;
/// The short side of an excused triangle lets lengths spread if they are below this share of it.
constexpr double kCutShare = 0.7;
/// Where a floor matters, pieces are this many times as long: they are halved while their halves are not shorter.
constexpr double kOverFloor = 1.4;
/// An edge is cut at all if so many pieces are expected.
constexpr double kAnyPieces = 1.3;
/// The floor is this fraction of the features, and this many roundings at least (see segment_table.cpp).
constexpr double kFloorShare = 0x1p-6, kRoundings = 0x1p10;
/// No more triangles around an edge are looked at.
constexpr std::size_t kTriangles = 24;
/// A length is changed only if it becomes smaller by more than this factor.
constexpr double kLess = 0.9;
/// The samples of an edge are looked at one after the other if there are no more than these.
constexpr std::uint32_t kFewSamples = 6;
/// Sizes at two places are not told apart if they differ by at most this factor.
constexpr double kAboutSame = 0.1;
/// No length is a smaller part of its edge than this.
constexpr double kSmallest = 0x1p-60;

double length_of(Vec2 way) { return std::sqrt(dot(way, way)); }

double distance_from(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 ab = b - a, ap = p - a;
  const double along = dot(ap, ab), squared = dot(ab, ab);
  if (along <= 0) return length_of(ap);
  if (along >= squared) return length_of(p - b);
  return std::fabs(cross(ab, ap)) / std::sqrt(squared);
}

/// Returns the distance between two segments that do not cross.
double distance_between(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return std::min({distance_from(a, b, c), distance_from(a, b, d), distance_from(c, d, a), distance_from(c, d, b)});
}

/// Returns the largest coordinate of a patch in space, up to its sign.
double magnitude_of(const PatchMesh& patch, const PatchChart& chart) {
  double largest = 0;
  for (const Vec2 place : patch.uv) {
    const Vec3 p = chart.to_space(place);
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  }
  return largest;
}

}  // namespace

double EdgeSizes::asked_for(const Goals& goals, const SizeField& sizes, const PatchChart& chart, Vec2 place) {
  static const double ideal = std::sqrt(kFacesPerIdeal);
  const double longest = std::min(sizes.largest(), equilateral_edge(goals.max_area));
  return (sizes.is_uniform() ? longest : std::min(longest, sizes.at(chart.to_space(place)))) / ideal;
}

EdgeSizes::EdgeSizes(const SampledEdges& edges, const TriangulatedPatches& triangulated, const Goals& goals,
                     const SizeField& sizes, RunControl& control)
    : edges_(edges), goals_(goals), sizes_(sizes), limits_(edges.size()) {
  const auto tangent_of = [](double degrees) { return std::tan(degrees * std::numbers::pi / 180); };
  slack_ = 1 - std::pow(goals.min_angle_deg / kHopelessDeg, 4);
  growth_ = kGrowth * slack_;
  tangent_ = tangent_of(goals.min_angle_deg);
  beside_segment_ = 2 / tangent_of(std::max(goals.min_angle_deg, least_strip_angle_deg(sizes)));
  beside_vertex_ = kBesideVertex * slack_ * 2 / tangent_;
  StopCheck check(control);
  length_.resize(edges.sample_count());
  for (std::uint32_t i = 0; i < edges.size(); ++i) {
    check();
    const SampledEdge& e = edges[i];
    const double most = (e.is_constrained ? 1 : kInside * slack_) * e.length;
    std::fill_n(length_.begin() + e.first_sample, e.sample_count, most);
  }
  find_excused(triangulated, control);
  for (std::size_t p = 0; p < triangulated.size(); ++p) {
    const PatchMesh& patch = triangulated.meshes[PatchId(p)];
    const PatchChart chart = triangulated.charts[PatchId(p)];
    const double rounding = 0x1p-52 * magnitude_of(patch, chart);
    std::vector<std::uint32_t> seen(patch.mesh.triangle_count(), Mesh::kNoHalfEdge);
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
      check();
      const EdgeSide side{PatchId(p), h};
      if (patch.mesh.is_constrained(h)) look_around(side, seen, std::max(rounding, chart.grid() * edges.scale(side)));
    }
  }
  limit_by_goals(triangulated, control);
  spread(control);
}

/// Finds the triangles whose only angle below the bound is one between two constrained edges.
void EdgeSizes::find_excused(const TriangulatedPatches& triangulated, RunControl& control) {
  StopCheck check(control);
  excused_side_.assign(edges_.triangle_count(), kNoSide);
  for (std::size_t p = 0; p < triangulated.size(); ++p) {
    const PatchMesh& patch = triangulated.meshes[PatchId(p)];
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
      check();
      if (!patch.mesh.is_constrained(Mesh::next(h)) || !patch.mesh.is_constrained(Mesh::previous(h))) continue;
      const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
      const auto is_small = [&](Vec2 u, Vec2 v) { return std::fabs(cross(u, v)) < tangent_ * dot(u, v); };
      if (is_small(a - c, b - c) && !is_small(c - a, b - a) && !is_small(c - b, a - b))
        excused_side_[edges_.triangle_of({PatchId(p), h})] = static_cast<std::uint8_t>(h % 3);
    }
  }
}

void EdgeSizes::limit_by_point(EdgeSide side, Vec2 point) {
  const SampledEdge& e = edges_[edges_.edge_at(side)];
  const SampledEdges::Way way = edges_.way(side);
  const double factor = beside_vertex_ * edges_.scale(side);
  for (std::uint32_t n = e.first_sample; n < e.first_sample + e.sample_count; ++n)
    length_[n] = std::min(length_[n], factor * length_of(way.at(edges_.place(n)) - point));
}

void EdgeSizes::limit_by_segment(EdgeSide side, Vec2 from, Vec2 to) {
  const SampledEdge& e = edges_[edges_.edge_at(side)];
  const SampledEdges::Way way = edges_.way(side);
  const double factor = beside_segment_ * edges_.scale(side);
  for (std::uint32_t n = e.first_sample; n < e.first_sample + e.sample_count; ++n)
    length_[n] = std::min(length_[n], factor * distance_from(from, to, way.at(edges_.place(n))));
}

/// Looks for vertices and edges that are near a constrained edge in one of its patches and do not touch it. These limit
/// the lengths of its pieces, and its floor.
/// Input: `seen` has one entry per triangle of the patch; `rounding` is a step of coordinates, in model units.
void EdgeSizes::look_around(EdgeSide side, std::vector<std::uint32_t>& seen, double rounding) {
  const PatchMesh& patch = edges_.patch(side);
  const Mesh& mesh = patch.mesh;
  const std::uint32_t h = side.half_edge, i = edges_.edge_at(side), start = mesh.from(h), end = mesh.to(h);
  const SampledEdge& e = edges_[i];
  const Vec2 a = patch.uv[start], b = patch.uv[end];
  const double scale = edges_.scale(side);
  const auto is_own = [&](std::uint32_t v) { return v == start || v == end; };
  // What lies beyond an edge that leaves one end of this edge backwards is seen from the short edges at that end.
  const auto leads_away = [&](std::uint32_t g) {
    const Vec2 c = patch.uv[mesh.from(g)], d = patch.uv[mesh.to(g)];
    const bool is_from_own = is_own(mesh.from(g));
    const bool is_at_start = (is_from_own ? mesh.from(g) : mesh.to(g)) == start;
    const double along = dot(is_from_own ? d - c : c - d, b - a);
    return is_at_start ? along <= 0 : along >= 0;
  };
  const auto limits = [&](double distance, double factor) { return factor * distance * scale < e.length; };
  const std::uint8_t excused = excused_side_[edges_.triangle_of(side)];
  const bool is_long_side_of_excused = excused != kNoSide && excused != h % 3;
  double nearest = length_of(b - a);
  std::uint32_t queue[kTriangles] = {h};
  std::size_t count = 1;
  seen[h / 3] = h;
  for (std::size_t k = 0; k < count; ++k) {
    const std::uint32_t v = mesh.apex(queue[k]);
    if (!is_own(v)) {
      const double distance = distance_from(a, b, patch.uv[v]);
      nearest = std::min(nearest, distance);
      if (limits(distance, beside_vertex_) && !(k == 0 && is_long_side_of_excused)) limit_by_point(side, patch.uv[v]);
    }
    for (const std::uint32_t g : {Mesh::next(queue[k]), Mesh::previous(queue[k])}) {
      const bool touches = is_own(mesh.from(g)) || is_own(mesh.to(g));
      const Vec2 c = patch.uv[mesh.from(g)], d = patch.uv[mesh.to(g)];
      const double distance = touches ? 0 : distance_between(a, b, c, d);
      if (mesh.is_constrained(g)) {
        if (touches) continue;
        nearest = std::min(nearest, distance);
        if (limits(distance, beside_segment_)) limit_by_segment(side, c, d);
        continue;
      }
      const std::uint32_t twin = mesh.twin(g);
      if (twin == Mesh::kNoHalfEdge || seen[twin / 3] == h || count == kTriangles) continue;
      if (!limits(distance, std::max(beside_vertex_, beside_segment_))) continue;
      if (touches && leads_away(g)) continue;
      seen[twin / 3] = h;
      queue[count++] = twin;
    }
  }
  Limits& limit = limits_[i];
  limit.feature = std::min(limit.feature, nearest * scale);
  limit.noise = std::max(limit.noise, kRoundings * rounding);
}

/// Limits lengths by the sizes that are asked for, and by floors.
void EdgeSizes::limit_by_goals(const TriangulatedPatches& triangulated, RunControl& control) {
  StopCheck check(control);
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    check();
    const SampledEdge& e = edges_[i];
    Limits& limit = limits_[i];
    limit.floor = goals_.min_edge_length;
    if (e.is_constrained) {
      limit.has_no_room = !(limit.feature > limit.noise) || limit.feature < goals_.min_edge_length;
      limit.floor = std::max({limit.floor, limit.noise, kFloorShare * limit.feature});
    }
    const double least = std::max(std::min(e.length, kOverFloor * limit.floor), kSmallest * e.length);
    const EdgeSide side = edges_.sides(e).front();
    const SampledEdges::Way way = edges_.way(side);
    // The sizes that are asked for in triangles are smaller than the longest edge by this factor.
    const double longest_per_size = std::sqrt(kFacesPerIdeal);
    const PatchChart chart = sizes_.is_uniform() ? PatchChart() : triangulated.charts[side.patch];
    const double in_middle = asked_for(goals_, sizes_, chart, way.at(0.5));
    double read_at = 0.5, asked = in_middle;
    for (std::uint32_t n = e.first_sample; n < e.first_sample + e.sample_count; ++n) {
      const double apart = std::fabs(edges_.place(n) - read_at) * e.length;
      const bool is_about_same = sizes_.slope() * apart <= kAboutSame * asked;
      if (!sizes_.is_uniform() && !is_about_same && asked - sizes_.slope() * apart < length_[n]) {
        read_at = edges_.place(n);
        asked = asked_for(goals_, sizes_, chart, way.at(read_at));
      }
      length_[n] = limit.has_no_room ? e.length : std::max(least, std::min(length_[n], asked));
      limit.longest = std::max(limit.longest, length_[n]);
    }
    const double longest = longest_per_size * in_middle;
    if (longest > limit.floor) limit.pieces = std::max(1.0, std::ceil(e.length / longest * (1 - 1e-9)));
  }
}

/// The samples that wait for being spread from, in buckets of like lengths. The shortest come first, so few lengths are
/// changed more than once.
struct EdgeSizes::Spreading {
  struct Item {
    std::uint32_t edge, sample;
  };

  explicit Spreading(std::vector<double>& its_lengths) : lengths(its_lengths) {
    double most = 0;
    least = HUGE_VAL;
    for (const double length : lengths) {
      if (length > 0) least = std::min(least, length);
      if (std::isfinite(length)) most = std::max(most, length);
    }
    buckets.resize(most > 0 ? bucket_of(most) + 1 : 1);
  }

  /// Returns the number of a length's bucket. There is one for each factor of the root of two.
  std::size_t bucket_of(double length) const {
    const double ratio = std::clamp(length / least, 1.0, 0x1p200);
    return static_cast<std::size_t>(std::ilogb(ratio * ratio));
  }

  void put(std::uint32_t edge, std::uint32_t sample) {
    buckets[std::min(bucket_of(lengths[sample]), buckets.size() - 1)].push_back({edge, sample});
  }

  /// Makes the length at a sample no larger than `most`, but not smaller than its floor allows.
  void offer(std::uint32_t edge, const Limits& limit, std::uint32_t sample, double most) {
    most = std::max(most, kOverFloor * limit.floor);
    if (!(most < kLess * lengths[sample])) return;
    lengths[sample] = most;
    put(edge, sample);
  }

  std::vector<double>& lengths;
  double least;
  std::vector<std::vector<Item>> buckets;
};

void EdgeSizes::spread(RunControl& control) {
  StopCheck check(control);
  Spreading spreading(length_);
  std::vector<double> last_spread(length_.size(), HUGE_VAL);
  for (std::uint32_t i = 0; i < edges_.size(); ++i) {
    check();
    for (std::uint32_t k = 0; k < edges_[i].sample_count; ++k) spreading.put(i, edges_[i].first_sample + k);
  }
  for (std::size_t b = 0; b < spreading.buckets.size(); ++b) {
    for (std::size_t k = 0; k < spreading.buckets[b].size(); ++k) {
      check();
      const auto [edge, sample] = spreading.buckets[b][k];
      // A sample may be here more than once, or have been in an earlier bucket since it became shorter.
      if (!(length_[sample] < last_spread[sample])) continue;
      last_spread[sample] = length_[sample];
      if (!limits_[edge].has_no_room) spread_along(edge, sample, spreading);
      spread_across(edge, sample, spreading);
    }
    spreading.buckets[b] = {};
  }
}

/// Spreads the length at a sample to the samples beside it on its edge.
void EdgeSizes::spread_along(std::uint32_t edge, std::uint32_t sample, Spreading& to) const {
  const SampledEdge& e = edges_[edge];
  const auto offer = [&](std::uint32_t n) {
    const double way = std::fabs(edges_.place(n) - edges_.place(sample)) * e.length;
    to.offer(edge, limits_[edge], n, length_[sample] + growth_ * way);
  };
  if (sample > e.first_sample) offer(sample - 1);
  if (sample + 1 < e.first_sample + e.sample_count) offer(sample + 1);
}

/// Spreads the length at a sample to the other edges of the triangles beside it.
void EdgeSizes::spread_across(std::uint32_t edge, std::uint32_t sample, Spreading& to) {
  const SampledEdge& e = edges_[edge];
  const double length = length_[sample];
  for (const std::uint32_t h : edges_.half_edges(e)) {
    if (excused_side_[h / 3] == h % 3 && length > kCutShare * e.length) continue;
    for (const bool is_next : {true, false}) {
      const std::uint32_t g = is_next ? Mesh::next(h) : Mesh::previous(h), other = edges_.edge_of(g);
      Limits& limit = limits_[other];
      if (limit.has_no_room || !(length < kLess * limit.longest)) continue;
      // Both edges begin at one corner of the triangle. Distances along them are counted from there.
      const double versine = edges_.versine(is_next ? g : h), place = edges_.place(sample);
      const double here = (edges_.is_forward(h) != is_next ? place : 1 - place) * e.length;
      const bool begins_there = edges_.is_forward(g) == is_next;
      const SampledEdge& there = edges_[other];
      // On a long edge, only the samples near the foot are looked at.
      std::uint32_t first = there.first_sample;
      double last_place = 1;
      const double half = (kLess * limit.longest - length) / growth_;
      if (there.sample_count > kFewSamples && 2 * half < there.length) {
        const double foot = here * (1 - versine) / there.length, part = half / there.length;
        const double middle = begins_there ? foot : 1 - foot;
        first = edges_.first_sample_after(there, middle - part);
        last_place = middle + part;
      } else {
        limit.longest = 0;
      }
      const std::uint32_t end = there.first_sample + there.sample_count;
      for (std::uint32_t n = first; n < end && edges_.place(n) <= last_place; ++n) {
        const double reach = (kLess * length_[n] - length) / growth_;
        if (reach > 0) {
          const double from_corner = (begins_there ? edges_.place(n) : 1 - edges_.place(n)) * there.length;
          const double apart = here - from_corner, squared = apart * apart + 2 * here * from_corner * versine;
          if (squared < reach * reach) to.offer(other, limit, n, length + growth_ * std::sqrt(squared));
        }
        limit.longest = std::max(limit.longest, length_[n]);
      }
    }
  }
}

double EdgeSizes::pieces(std::uint32_t edge) const {
  const SampledEdge& e = edges_[edge];
  if (!e.is_constrained || limits_[edge].has_no_room || !(e.length > 0)) return 1;
  double pieces = 0;
  for (std::uint32_t n = e.first_sample; n + 1 < e.first_sample + e.sample_count; ++n) {
    const double part = (edges_.place(n + 1) - edges_.place(n)) * e.length;
    const double a = length_[n], b = length_[n + 1];
    // This is the integral of one over a length that changes evenly.
    pieces += part * (std::fabs(b - a) > 1e-3 * a ? std::log(b / a) / (b - a) : 1 / a);
  }
  return std::max(pieces < kAnyPieces ? 1 : pieces, limits_[edge].pieces);
}

}  // namespace remesh
