#include "core/refinement/prediction/edge_sizes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/prefault_pages.h"
#include "core/base/stoppable.h"
#include "core/refinement/goals/min_spacing.h"
#include "core/refinement/segments/strips.h"

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
/// The floor is this many roundings at least (see segment_table.cpp).
constexpr double kRoundingsOfCut = 0x1p10;
/// No more triangles around an edge are looked at.
constexpr std::size_t kTriangles = 24;
/// A length is changed only if it becomes smaller by more than this factor.
constexpr double kLess = 0.9;
/// The samples of an edge are looked at one after the other if there are no more than these.
constexpr std::uint32_t kFewSamples = 6;
/// Sizes at two places are not told apart if they differ by at most this factor.
constexpr double kAboutSame = 0.1;
/// Patches and edges are looked at in blocks of these sizes.
constexpr std::size_t kPatchesPerBlock = 64, kEdgesPerBlock = 512;
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

}  // namespace

/// Looks for vertices and edges that are near a constrained edge in one of its patches and do not touch it. These limit
/// the lengths of its pieces, and its floor. Triangles are looked at from the edge outwards.
class EdgeSizes::LookAround {
 public:
  /// Tells whether lengths are limited by what is found, or only distances are measured.
  enum class Finds { kLimits, kDistance };

  LookAround(EdgeSizes& sizes, EdgeSide side, Finds finds)
      : sizes_(sizes),
        finds_(finds),
        side_(side),
        edge_(sizes.edges_[sizes.edges_.edge_at(side)]),
        patch_(sizes.edges_.patch(side)),
        mesh_(patch_.mesh),
        scale_(sizes.edges_.scale(side)),
        start_(mesh_.from(side.half_edge)),
        end_(mesh_.to(side.half_edge)),
        a_(patch_.uv[start_]),
        b_(patch_.uv[end_]),
        nearest_(length_of(b_ - a_)) {
    enter(side.half_edge);
  }

  /// Returns the distance to the nearest thing that was found, in model units. It is not more than the edge is long.
  double run() {
    for (std::size_t k = 0; k < count_; ++k) {
      const std::uint32_t h = queue_[k];
      look_at_vertex(mesh_.apex(h), k == 0);
      for (const std::uint32_t g : {Mesh::next(h), Mesh::previous(h)}) look_at_edge(g);
    }
    return nearest_ * scale_;
  }

 private:
  bool is_own(std::uint32_t v) const { return v == start_ || v == end_; }
  /// Returns whether anything that is so far away limits lengths.
  bool is_in_reach(double distance, double factor) const { return factor * distance * scale_ < edge_.length; }

  void look_at_vertex(std::uint32_t v, bool is_first) {
    if (is_own(v)) return;
    const Vec2 point = patch_.uv[v];
    const double distance = distance_from(a_, b_, point);
    nearest_ = std::min(nearest_, distance);
    if (finds_ == Finds::kDistance || !is_in_reach(distance, sizes_.beside_vertex_)) return;
    const std::uint8_t excused = sizes_.excused_side_[sizes_.edges_.triangle_of(side_)];
    const bool is_long_side_of_excused = excused != kNoSide && excused != side_.half_edge % 3;
    if (!(is_first && is_long_side_of_excused)) sizes_.limit_by_point(side_, point);
  }

  void look_at_edge(std::uint32_t g) {
    const bool touches = is_own(mesh_.from(g)) || is_own(mesh_.to(g)), is_constrained = mesh_.is_constrained(g);
    if (touches && is_constrained) return;
    const Vec2 c = patch_.uv[mesh_.from(g)], d = patch_.uv[mesh_.to(g)];
    const double distance = touches ? 0 : distance_between(a_, b_, c, d);
    if (is_constrained) {
      nearest_ = std::min(nearest_, distance);
      // Beside an edge that stays as it is, no cut makes the angles better.
      const bool is_fixed = sizes_.limits_[sizes_.edges_.edge_at({side_.patch, g})].has_no_room;
      const bool is_limit = finds_ == Finds::kLimits && !is_fixed;
      if (is_limit && is_in_reach(distance, sizes_.beside_segment_)) sizes_.limit_by_segment(side_, c, d);
      return;
    }
    const std::uint32_t twin = mesh_.twin(g);
    if (twin == Mesh::kNoHalfEdge || count_ == kTriangles) return;
    if (!is_in_reach(distance, std::max(sizes_.beside_vertex_, sizes_.beside_segment_))) return;
    if (touches && leads_away(g)) return;
    const auto triangles_end = triangle_.begin() + static_cast<std::ptrdiff_t>(count_);
    if (std::find(triangle_.begin(), triangles_end, twin / 3) == triangles_end) enter(twin);
  }

  /// Returns whether an edge leaves one end of this edge backwards. The short edges at that end see the things beyond.
  bool leads_away(std::uint32_t g) const {
    const Vec2 c = patch_.uv[mesh_.from(g)], d = patch_.uv[mesh_.to(g)];
    const bool is_from_own = is_own(mesh_.from(g));
    const bool is_at_start = (is_from_own ? mesh_.from(g) : mesh_.to(g)) == start_;
    const double along = dot(is_from_own ? d - c : c - d, b_ - a_);
    return is_at_start ? along <= 0 : along >= 0;
  }

  void enter(std::uint32_t h) {
    triangle_[count_] = h / 3;
    queue_[count_++] = h;
  }

  EdgeSizes& sizes_;
  const Finds finds_;
  const EdgeSide side_;
  const SampledEdge& edge_;
  const PatchMesh& patch_;
  const Mesh& mesh_;
  const double scale_;
  const std::uint32_t start_, end_;
  const Vec2 a_, b_;
  double nearest_;
  std::array<std::uint32_t, kTriangles> queue_;     ///< the half-edges through which triangles were entered
  std::array<std::uint32_t, kTriangles> triangle_;  ///< their triangles
  std::size_t count_ = 0;
};

/// Spreads lengths from sample to sample. Samples that wait for being spread from are in buckets of like lengths. The
/// shortest come first, so few lengths are changed more than once.
///
/// A sample that got its length from another one has less to spread: the other one has spread to all of its triangles
/// itself, on ways that are no longer. So only the triangles on the other sides of an edge are left, and nothing at all
/// if the other sample is on the same edge.
class EdgeSizes::Spreading {
 public:
  Spreading(EdgeSizes& sizes, RunControl& control)
      : sizes_(sizes), edges_(sizes.edges_), lengths_(sizes.length_), control_(control) {
    control.memory().ask_for<Item>(lengths_.size());
    from_.assign(lengths_.size(), kNowhere);
    double shortest = std::numeric_limits<double>::max(), longest = 0;
    for (const double length : lengths_) {
      if (length > 0) shortest = std::min(shortest, length);
      if (std::isfinite(length)) longest = std::max(longest, length);
    }
    first_step_ = step_of(shortest);
    buckets_.resize(longest > 0 ? step_of(longest) - first_step_ + 1 : 1);
  }

  void run() {
    StopCheck check(control_);
    for (std::uint32_t i = 0; i < edges_.size(); ++i) {
      check();
      begin_at(i);
    }
    for (std::vector<Item>& bucket : buckets_) {
      // More items may come into the bucket meanwhile.
      for (std::size_t k = 0; k < bucket.size(); ++k) {
        check();
        spread_from(bucket[k]);
      }
      bucket = {};
    }
  }

 private:
  /// These stand beside half-edges of triangles through which lengths came.
  static constexpr std::uint32_t kNowhere = 0xffffffff;  ///< there is nothing to spread
  static constexpr std::uint32_t kItself = 0xfffffffe;   ///< the length is the sample's own

  struct Item {
    std::uint32_t edge, sample;
  };

  /// Returns a number that grows with the length, by eight for each factor of two: it is the exponent and three bits of
  /// the fraction.
  static std::size_t step_of(double length) { return std::bit_cast<std::uint64_t>(length) >> 49; }

  void put(std::uint32_t edge, std::uint32_t sample, std::uint32_t from) {
    from_[sample] = from;
    const std::size_t step = std::max(step_of(lengths_[sample]), first_step_);
    buckets_[std::min(step - first_step_, buckets_.size() - 1)].push_back({edge, sample});
  }

  /// Makes the length at a sample no larger than `length`, but not smaller than its floor allows.
  bool lower(const Limits& limit, std::uint32_t sample, double length) {
    length = std::max(length, kOverFloor * limit.floor);
    if (!(length < kLess * lengths_[sample])) return false;
    lengths_[sample] = length;
    return true;
  }

  /// Puts the samples of an edge that are shorter than any length beside them.
  void begin_at(std::uint32_t edge) {
    const SampledEdge& e = edges_[edge];
    double longest = sizes_.limits_[edge].longest;
    for (const std::uint32_t h : edges_.half_edges(e))
      for (const std::uint32_t g : {Mesh::next(h), Mesh::previous(h)}) {
        const Limits& limit = sizes_.limits_[edges_.edge_of(g)];
        if (!limit.has_no_room) longest = std::max(longest, limit.longest);
      }
    for (std::uint32_t n = e.first_sample; n < e.first_sample + e.sample_count; ++n)
      if (lengths_[n] < kLess * longest) put(edge, n, kItself);
  }

  void spread_from(Item item) {
    const std::uint32_t from = std::exchange(from_[item.sample], kNowhere);
    // A sample may be in several buckets.
    if (from == kNowhere) return;
    if (from == kItself && !sizes_.limits_[item.edge].has_no_room) spread_along(item);
    for (const std::uint32_t h : edges_.half_edges(edges_[item.edge]))
      if (h != from) spread_across(item, h);
  }

  /// Spreads the length at a sample along its edge, up to those samples whose lengths are not changed.
  void spread_along(Item item) {
    const SampledEdge& e = edges_[item.edge];
    const double length = lengths_[item.sample];
    const auto reaches = [&](std::uint32_t n) {
      const double way = std::fabs(edges_.place(n) - edges_.place(item.sample)) * e.length;
      if (!lower(sizes_.limits_[item.edge], n, length + sizes_.growth_ * way)) return false;
      from_[n] = kNowhere;
      return true;
    };
    for (std::uint32_t n = item.sample; n > e.first_sample && reaches(n - 1);) --n;
    for (std::uint32_t n = item.sample + 1; n < e.first_sample + e.sample_count && reaches(n);) ++n;
  }

  /// Spreads the length at a sample to the other edges of the triangle of h, which is a half-edge of its edge.
  void spread_across(Item item, std::uint32_t h) {
    const SampledEdge& e = edges_[item.edge];
    if (sizes_.excused_side_[h / 3] == h % 3 && lengths_[item.sample] > kCutShare * e.length) return;
    const double place = edges_.place(item.sample);
    for (const bool is_next : {true, false}) {
      const std::uint32_t g = is_next ? Mesh::next(h) : Mesh::previous(h);
      const Limits& limit = sizes_.limits_[edges_.edge_of(g)];
      if (limit.has_no_room || !(lengths_[item.sample] < kLess * limit.longest)) continue;
      // Both edges begin at one corner of the triangle. Distances along them are counted from there.
      const double here = (edges_.is_forward(h) != is_next ? place : 1 - place) * e.length;
      spread_to({g, edges_.is_forward(g) == is_next, here, edges_.versine(is_next ? g : h), lengths_[item.sample]});
    }
  }

  /// A way from a sample to another edge of a triangle. The two edges meet in a corner.
  struct Across {
    std::uint32_t half_edge;  ///< of the other edge
    bool begins_there;        ///< whether the samples of the other edge begin at the corner
    double here;              ///< the distance of the sample from the corner
    double versine;           ///< of the angle at the corner
    double length;            ///< the length at the sample
  };

  void spread_to(const Across& way) {
    const std::uint32_t other = edges_.edge_of(way.half_edge);
    Limits& limit = sizes_.limits_[other];
    const double reach = (kLess * limit.longest - way.length) * per_growth_;
    const double sine_squared = way.versine < 1 ? way.versine * (2 - way.versine) : 1;
    if (way.here * way.here * sine_squared >= reach * reach) return;
    // On a long edge, only the samples near the foot are looked at.
    const SampledEdge& there = edges_[other];
    std::uint32_t first = there.first_sample;
    double last_place = 1;
    if (there.sample_count > kFewSamples && 2 * reach < there.length) {
      const double foot = way.here * (1 - way.versine) / there.length, part = reach / there.length;
      const double middle = way.begins_there ? foot : 1 - foot;
      first = edges_.first_sample_after(there, middle - part);
      last_place = middle + part;
    } else {
      limit.longest = 0;
    }
    const bool is_end = there.side_count < 2;
    const std::uint32_t end = there.first_sample + there.sample_count;
    for (std::uint32_t n = first; n < end && edges_.place(n) <= last_place; ++n) {
      const double from_corner = (way.begins_there ? edges_.place(n) : 1 - edges_.place(n)) * there.length;
      if (offer(way, from_corner, limit, n)) {
        if (is_end) {
          from_[n] = kNowhere;
        } else {
          put(other, n, way.half_edge);
        }
      }
      limit.longest = std::max(limit.longest, lengths_[n]);
    }
  }

  /// Offers a length to a sample of the other edge, and returns whether it is lower there.
  bool offer(const Across& way, double from_corner, const Limits& limit, std::uint32_t sample) {
    const double reach = (kLess * lengths_[sample] - way.length) * per_growth_;
    if (!(reach > 0)) return false;
    const double apart = way.here - from_corner;
    if (std::fabs(apart) >= reach) return false;
    const double squared = apart * apart + 2 * way.here * from_corner * way.versine;
    return squared < reach * reach && lower(limit, sample, way.length + sizes_.growth_ * std::sqrt(squared));
  }

  EdgeSizes& sizes_;
  const SampledEdges& edges_;
  std::vector<double>& lengths_;
  RunControl& control_;
  const double per_growth_ = 1 / sizes_.growth_;
  std::size_t first_step_;           ///< of the shortest length
  std::vector<std::uint32_t> from_;  ///< one per sample: where its length came from, if it has to be spread
  std::vector<std::vector<Item>> buckets_;
};

double EdgeSizes::asked_for(const Goals& goals, const SizeField& sizes, const PatchChart& chart, Vec2 place) {
  static const double ideal = std::sqrt(kFacesPerIdeal);
  const double longest = std::min(sizes.largest(), equilateral_edge(goals.max_area));
  return (sizes.is_uniform() ? longest : std::min(longest, sizes.at(chart.to_space(place)))) / ideal;
}

EdgeSizes::EdgeSizes(const SampledEdges& edges, const TriangulatedPatches& triangulated, const Goals& goals,
                     const SizeField& sizes, RunControl& control)
    : edges_(edges), goals_(goals), sizes_(sizes) {
  const auto tangent_of = [](double degrees) { return std::tan(degrees * std::numbers::pi / 180); };
  slack_ = 1 - std::pow(goals.min_angle_deg / kHopelessDeg, 4);
  growth_ = kGrowth * slack_;
  tangent_ = tangent_of(goals.min_angle_deg);
  beside_segment_ = 2 / tangent_of(std::max(goals.min_angle_deg, least_strip_angle_deg(sizes)));
  beside_vertex_ = kBesideVertex * slack_ * 2 / tangent_;
  if (sizes.is_uniform()) asked_ = asked_for(goals, sizes, PatchChart(), {});
  reserve_pages(length_, edges.sample_count(), control);
  length_.resize(edges.sample_count());
  reserve_pages(limits_, edges.size(), control);
  limits_.resize(edges.size());
  excused_side_.assign(edges_.triangle_count(), kNoSide);
  find_excused(triangulated, control);
  if (goals.min_edge_length > 0) find_room(control);
  limit_all(triangulated, control);
  Spreading(*this, control).run();
  for_blocks(edges.size(), kEdgesPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) count_pieces(static_cast<std::uint32_t>(i));
  });
}

/// Finds the triangles whose only angle below the bound is one between two constrained edges.
void EdgeSizes::find_excused(const TriangulatedPatches& triangulated, RunControl& control) {
  for_blocks(triangulated.size(), kPatchesPerBlock, control, [&](std::size_t begin, std::size_t end) {
    StopCheck check(control);
    for (PatchId p(static_cast<std::uint32_t>(begin)); p.value < end; ++p.value) {
      const PatchMesh& patch = triangulated.meshes[p];
      for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h) {
        check();
        if (!patch.mesh.is_constrained(Mesh::next(h)) || !patch.mesh.is_constrained(Mesh::previous(h))) continue;
        const Vec2 a = patch.uv[patch.mesh.from(h)], b = patch.uv[patch.mesh.to(h)], c = patch.uv[patch.mesh.apex(h)];
        const auto is_small = [&](Vec2 u, Vec2 v) { return std::fabs(cross(u, v)) < tangent_ * dot(u, v); };
        if (is_small(a - c, b - c) && !is_small(c - a, b - a) && !is_small(c - b, a - b))
          excused_side_[edges_.triangle_of({p, h})] = static_cast<std::uint8_t>(h % 3);
      }
    }
  });
}

/// Finds the edges that are narrower than the shortest edge allowed. They stay as they are.
void EdgeSizes::find_room(RunControl& control) {
  std::vector<std::uint8_t> has_no_room(edges_.size(), 0);
  for_blocks(edges_.size(), kEdgesPerBlock, control, [&](std::size_t begin, std::size_t end) {
    StopCheck check(control);
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      check();
      const SampledEdge& e = edges_[i];
      for (const EdgeSide side : e.is_constrained ? edges_.sides(e) : std::span<const EdgeSide>())
        if (LookAround(*this, side, LookAround::Finds::kDistance).run() < goals_.min_edge_length) has_no_room[i] = 1;
    }
  });
  for (std::uint32_t i = 0; i < edges_.size(); ++i) limits_[i].has_no_room = has_no_room[i] != 0;
}

/// Limits the lengths of all edges by what is near them and by the goals. Each edge is on its own.
void EdgeSizes::limit_all(const TriangulatedPatches& triangulated, RunControl& control) {
  for_blocks(edges_.size(), kEdgesPerBlock, control, [&](std::size_t begin, std::size_t end) {
    StopCheck check(control);
    for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
      const SampledEdge& e = edges_[i];
      const double longest = (e.is_constrained ? 1 : kInside * slack_) * e.length;
      std::fill_n(length_.begin() + e.first_sample, e.sample_count, longest);
      Surroundings near;
      check();
      for (const EdgeSide side : e.is_constrained ? edges_.sides(e) : std::span<const EdgeSide>()) {
        near.feature = std::min(near.feature, LookAround(*this, side, LookAround::Finds::kLimits).run());
        near.noise = std::max(near.noise, kRoundingsOfCut * edges_.rounding(side));
      }
      limit_by_goals(i, near, triangulated);
    }
  });
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

/// Limits the lengths of an edge by the sizes that are asked for, and by floors.
void EdgeSizes::limit_by_goals(std::uint32_t edge, const Surroundings& near, const TriangulatedPatches& triangulated) {
  const SampledEdge& e = edges_[edge];
  Limits& limit = limits_[edge];
  limit.floor = goals_.min_edge_length;
  if (e.is_constrained) {
    limit.has_no_room = !(near.feature > near.noise) || near.feature < goals_.min_edge_length;
    limit.floor = std::max({limit.floor, near.noise, kFloorShare * near.feature});
  }
  const double shortest = std::max(std::min(e.length, kOverFloor * limit.floor), kSmallest * e.length);
  const EdgeSide side = edges_.sides(e).front();
  const SampledEdges::Way way = edges_.way(side);
  const PatchChart chart = sizes_.is_uniform() ? PatchChart() : triangulated.charts[side.patch];
  const double in_middle = sizes_.is_uniform() ? asked_ : asked_for(goals_, sizes_, chart, way.at(0.5));
  double read_at = 0.5, asked = in_middle;
  const auto read_near = [&](std::uint32_t n) {
    const double apart = std::fabs(edges_.place(n) - read_at) * e.length;
    const bool is_about_same = sizes_.slope() * apart <= kAboutSame * asked;
    if (is_about_same || asked - sizes_.slope() * apart >= length_[n]) return;
    read_at = edges_.place(n);
    asked = asked_for(goals_, sizes_, chart, way.at(read_at));
  };
  for (std::uint32_t n = e.first_sample; n < e.first_sample + e.sample_count; ++n) {
    if (!sizes_.is_uniform()) read_near(n);
    length_[n] = limit.has_no_room ? e.length : std::max(shortest, std::min(length_[n], asked));
    limit.longest = std::max(limit.longest, length_[n]);
  }
  // The sizes that are asked for in triangles are smaller than the longest edge by this factor.
  const double longest = std::sqrt(kFacesPerIdeal) * in_middle;
  if (longest > limit.floor) limit.pieces = std::max(1.0, std::ceil(e.length / longest * (1 - 1e-9)));
}

/// Sets the number of pieces that an edge is expected to be cut into.
void EdgeSizes::count_pieces(std::uint32_t edge) {
  const SampledEdge& e = edges_[edge];
  Limits& limit = limits_[edge];
  if (!e.is_constrained || limit.has_no_room || !(e.length > 0)) {
    limit.pieces = 1;
    return;
  }
  double pieces = 0;
  for (std::uint32_t n = e.first_sample; n + 1 < e.first_sample + e.sample_count; ++n) {
    const double part = (edges_.place(n + 1) - edges_.place(n)) * e.length;
    const double a = length_[n], b = length_[n + 1];
    // This is the integral of one over a length that changes evenly.
    pieces += part * (std::fabs(b - a) > 1e-3 * a ? std::log(b / a) / (b - a) : 1 / a);
  }
  limit.pieces = std::max(pieces < kAnyPieces ? 1 : pieces, limit.pieces);
}

}  // namespace remesh
