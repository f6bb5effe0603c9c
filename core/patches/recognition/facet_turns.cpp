#include "core/patches/recognition/facet_turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

constexpr double kDegreesOfRadian = 180 / std::numbers::pi;
constexpr double kFullTurnOfFacets = 2 * std::numbers::pi;

/// A neighbour counts as beside a facet in a direction if their middles are at least this part of the facet's width
/// apart.
constexpr double kPartOfWidth = 0.25;
/// A direction counts if at least this part of the area belongs to facets with neighbours in it.
constexpr double kPartOfArea = 0.1;

/// A turn from one corner to the next counts if it is more than this part of the facet's turn.
constexpr double kPartOfSteps = 0.02;

/// An interval of angles.
struct AngleRange {
  double middle = 0, width = 0;
  double step = 0;  ///< the mean angle between neighbouring corners

  /// Returns the angle between the middles of two intervals, 0 to half a turn.
  double from(const AngleRange& other) const {
    return std::fabs(std::remainder(middle - other.middle, kFullTurnOfFacets));
  }
};

/// The directions in which facets have neighbours: around the axis, and across that.
constexpr std::size_t kAroundAxis = 0, kAcrossAxis = 1, kTurnDirections = 2;

/// The turn of the surface from a facet to its neighbours, in each direction. 0 means that there is no neighbour.
using FacetTurn = std::array<double, kTurnDirections>;

/// The angles of places around the axis of a surface, and around the tube of a torus.
class Turning {
 public:
  explicit Turning(const AnalyticSurface& shape)
      : shape_(shape), x_(unit_across(shape.axis)), y_(cross(shape.axis, x_)) {}

  double radius_of(const Vec3& place) const {
    const Vec3 q = place - shape_.origin;
    return std::hypot(dot(q, x_), dot(q, y_));
  }

  /// Returns whether a corner has an angle. Near the axis, as at the apex of a cone, the angle around the axis is mere
  /// rounding. `largest` is the largest radius of a corner of the facet.
  bool has_angle(std::size_t direction, const Vec3& place, double largest) const {
    constexpr double kNearAxis = 0.25;
    return direction == kAroundAxis ? radius_of(place) > kNearAxis * largest : shape_.kind == SurfaceKind::kTorus;
  }

  double angle(std::size_t direction, const Vec3& place) const {
    const Vec3 q = place - shape_.origin;
    if (direction == kAroundAxis) return std::atan2(dot(q, y_), dot(q, x_));
    return std::atan2(dot(q, shape_.axis), radius_of(place) - shape_.radius);
  }

  /// Returns whether a place between two angles is nearer to the circle than to the chord between these.
  bool is_off_chord(std::size_t direction, const Vec3& place, double from, double to) const {
    const Vec3 q = place - shape_.origin;
    const double along = dot(q, shape_.axis);
    double radius = radius_of(place), of_circle = 0;
    if (direction != kAroundAxis) {
      radius = std::hypot(along, radius - shape_.radius);
      of_circle = shape_.minor_radius;
    } else if (shape_.kind == SurfaceKind::kCylinder) {
      of_circle = shape_.radius;
    } else if (shape_.kind == SurfaceKind::kCone) {
      of_circle = std::fabs(along) * std::tan(shape_.half_angle);
    } else {
      return false;
    }
    const double half = 0.5 * std::remainder(to - from, kFullTurnOfFacets);
    const double of_chord =
        of_circle * std::cos(half) / std::cos(std::remainder(angle(direction, place) - from - half, kFullTurnOfFacets));
    return radius > 0.5 * (of_circle + of_chord);
  }

 private:
  const AnalyticSurface& shape_;
  Vec3 x_, y_;
};

/// Measures facets one by one. All lengths are in model units.
class TurnMeasure {
 public:
  TurnMeasure(const Facets& facets, const FacetGraph& graph, const RecognisedSurfaces& recognised)
      : facets_(facets), graph_(graph), recognised_(recognised) {}

  /// Measures the angles that the facets cover. A facet may share many sides with a neighbour.
  void measure_ranges(RunControl& control) {
    ranges_.resize(graph_.size());
    for_blocks(graph_.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (PatchId p(begin); p.value < end; ++p.value)
        if (is_measured(p) && surface_of(p).shape.kind != SurfaceKind::kSphere)
          ranges_[p] = ranges_of(p, surface_of(p).shape);
    });
  }

  FacetTurn turn_of(PatchId p) const {
    if (!is_measured(p)) return {};
    return surface_of(p).shape.kind == SurfaceKind::kSphere ? on_sphere(p) : around_axis(p);
  }

 private:
  using Ranges = std::array<AngleRange, kTurnDirections>;

  bool is_measured(PatchId p) const {
    const SurfaceKind kind = surface_of(p).shape.kind;
    return kind != SurfaceKind::kPlane && kind != SurfaceKind::kFree && graph_.may_be_seed(p);
  }
  const RecognisedSurface& surface_of(PatchId p) const { return recognised_.surfaces[recognised_.of_patch[p]]; }
  const Vec3& corner(std::uint32_t side) const { return facets_.surface.positions[graph_.vertex(side)]; }

  /// Returns whether two facets are of the same surface. `is_band` tells whether they are of two bands of it.
  bool is_same_surface(PatchId p, PatchId q, bool& is_band) const {
    is_band = false;
    if (recognised_.of_patch[p] == recognised_.of_patch[q]) return true;
    is_band = surface_of(p).whole.is_valid() && surface_of(p).whole == surface_of(q).whole;
    return is_band;
  }

  /// Returns the angles that a facet covers around the axis of a surface, and around the tube of a torus.
  Ranges ranges_of(PatchId p, const AnalyticSurface& shape) const {
    const Turning turning(shape);
    double largest = 0;
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s)
      largest = std::max(largest, turning.radius_of(corner(s)));
    Ranges ranges;
    std::array<double, kTurnDirections> first{}, low{}, high{};
    std::array<bool, kTurnDirections> is_any{};
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
      if (!graph_.is_corner(s)) continue;
      for (std::size_t d = 0; d < kTurnDirections; ++d) {
        if (!turning.has_angle(d, corner(s), largest)) continue;
        const double angle = turning.angle(d, corner(s));
        if (!is_any[d]) first[d] = angle;
        is_any[d] = true;
        const double way = std::remainder(angle - first[d], kFullTurnOfFacets);
        low[d] = std::min(low[d], way);
        high[d] = std::max(high[d], way);
      }
    }
    for (std::size_t d = 0; d < kTurnDirections; ++d) {
      ranges[d] = {first[d] + 0.5 * (low[d] + high[d]), high[d] - low[d], 0};
      ranges[d].step = mean_step(p, turning, d, largest, ranges[d].width);
    }
    return ranges;
  }

  /// Returns the mean angle between neighbouring corners of a facet. Where facets are so fine beside the rounding
  /// that several of them have become one plane, the corners between them still lie on the surface, and not on a chord.
  double mean_step(PatchId p, const Turning& turning, std::size_t d, double largest, double width) const {
    const std::uint32_t begin = graph_.sides_begin(p), end = graph_.sides_end(p);
    std::uint32_t first = begin;
    while (first < end && !graph_.is_corner(first)) ++first;
    if (first == end) return width;
    double sum = 0, count = 0, before = 0, chord_begin = 0;
    bool is_known = false;
    std::uint32_t next_corner = first;
    for (std::uint32_t i = 0; i <= end - begin; ++i) {
      const std::uint32_t s = begin + (first - begin + i) % (end - begin);
      if (!turning.has_angle(d, corner(s), largest)) {
        is_known = is_known && !graph_.is_corner(s);
        continue;
      }
      const double angle = turning.angle(d, corner(s));
      if (graph_.is_corner(s)) {
        chord_begin = angle;
        next_corner = s;
        do next_corner = next_corner + 1 == end ? begin : next_corner + 1;
        while (!graph_.is_corner(next_corner));
      } else if (!turning.is_off_chord(d, corner(s), chord_begin, turning.angle(d, corner(next_corner)))) {
        continue;
      }
      const double step = std::fabs(std::remainder(angle - before, kFullTurnOfFacets));
      // Sides along the surface, such as rulings, do not turn.
      if (is_known && step > kPartOfSteps * width) {
        sum += step;
        count += 1;
      }
      before = angle;
      is_known = true;
    }
    return count > 0 ? std::min(sum / count, width) : width;
  }

  FacetTurn around_axis(PatchId p) const {
    const AnalyticSurface& shape = surface_of(p).shape;
    const Ranges& own = ranges_[p];
    FacetTurn result{};
    graph_.for_each_neighbour(p, [&](PatchId q) {
      bool is_band = false;
      if (!is_same_surface(p, q, is_band) || !graph_.may_be_seed(q)) return;
      if (is_band) {
        const AnalyticSurface& beside = surface_of(q).shape;
        result[kAcrossAxis] = std::max(result[kAcrossAxis], std::fabs(slope(shape) - slope(beside)));
        return;
      }
      const Ranges& other = ranges_[q];
      for (std::size_t d = 0; d < kTurnDirections; ++d)
        if (own[d].from(other[d]) > kPartOfWidth * std::min(own[d].width, other[d].width)) result[d] = own[d].step;
    });
    return result;
  }

  /// Returns the angle between the rulings of a band and the axis.
  static double slope(const AnalyticSurface& band) { return band.kind == SurfaceKind::kCone ? band.half_angle : 0; }

  FacetTurn on_sphere(PatchId p) const {
    const double radius = surface_of(p).shape.radius;
    double widest = 0;
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
      const PatchId q = graph_.beyond(s);
      bool is_band = false;
      if (!q.is_valid() || !is_same_surface(p, q, is_band)) continue;
      const Vec3& from = corner(s);
      const Vec3 side = facets_.surface.positions[graph_.end_vertex(s)] - from;
      const Vec3 across = normalized(cross(graph_.normal(p), side));
      double low = 0, high = 0;
      for (std::uint32_t t = graph_.sides_begin(p); t < graph_.sides_end(p); ++t) {
        const double way = dot(corner(t) - from, across);
        low = std::min(low, way);
        high = std::max(high, way);
      }
      widest = std::max(widest, high - low);
    }
    FacetTurn result{};
    result[kAroundAxis] = 2 * std::asin(std::min(1.0, widest / (2 * radius)));
    return result;
  }

  const Facets& facets_;
  const FacetGraph& graph_;
  const RecognisedSurfaces& recognised_;
  IdVector<PatchId, Ranges> ranges_;
};

/// A turn, and the area for which it counts.
struct WeighedTurn {
  double turn, area;
  friend bool operator<(const WeighedTurn& a, const WeighedTurn& b) {
    return a.turn != b.turn ? a.turn < b.turn : a.area < b.area;
  }
};

/// Returns the weighted median of turns: half of the area has smaller ones.
double median_turn(std::vector<WeighedTurn>& turns, RunControl& control) {
  sort_stoppable(turns.begin(), turns.end(), control);
  double total = 0, sum = 0;
  for (const WeighedTurn& t : turns) total += t.area;
  for (const WeighedTurn& t : turns) {
    sum += t.area;
    if (2 * sum >= total) return t.turn;
  }
  return 0;
}

/// Returns whether a surface as a whole hardly turns. Such a surface is a plane whose facets rounding has tilted.
/// Input: `tolerance` - how far rounding may have moved corners, in model units.
bool is_nearly_flat(const Facets& facets, const FacetGraph& graph, std::span<const PatchId> of_surface,
                    double tolerance, StopCheck& check) {
  constexpr double kSineOfNoTurn = 0.0087;  // half a degree to each side
  Vec3 sum;
  for (const PatchId p : of_surface) {
    check();
    sum = sum + graph.area(p) * graph.normal(p);
  }
  if (!(norm(sum) > 0)) return false;
  const Vec3 mean = normalized(sum);
  bool is_turning = false;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const PatchId p : of_surface) {
    is_turning = is_turning || dot(graph.normal(p), mean) <= 0 || norm(cross(graph.normal(p), mean)) > kSineOfNoTurn;
    if (is_turning && high - low > 2 * tolerance) return false;
    for (std::uint32_t s = graph.sides_begin(p); s < graph.sides_end(p); ++s) {
      check();
      const double height = dot(facets.surface.positions[graph.vertex(s)], mean);
      low = std::min(low, height);
      high = std::max(high, height);
    }
  }
  return !is_turning || !(high - low > 2 * tolerance);
}

}  // namespace

void measure_turns(const Facets& facets, const FacetGraph& graph, RecognisedSurfaces& recognised, RunControl& control) {
  if (!graph.has_smooth_edges()) return;
  TurnMeasure measure(facets, graph, recognised);
  measure.measure_ranges(control);
  std::vector<FacetTurn> turns(graph.size());
  for_blocks(graph.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) turns[i] = measure.turn_of(PatchId(i));
  });
  // The facets of a band count for its surface of revolution.
  const auto surface_of = [&](std::uint32_t p) {
    const SurfaceId s = recognised.of_patch[PatchId(p)], whole = recognised.surfaces[s].whole;
    return whole.is_valid() ? whole.value : s.value;
  };
  const auto groups = group_by<PatchId>(graph.size(), recognised.surfaces.size(), surface_of, control);
  std::vector<WeighedTurn> counted;
  StopCheck check(control);
  for (std::size_t s = 0; s < recognised.surfaces.size(); ++s) {
    const std::span<const PatchId> of_surface(groups.items.data() + groups.begin[s],
                                              groups.begin[s + 1] - groups.begin[s]);
    RecognisedSurface& surface = recognised.surfaces[SurfaceId(s)];
    if (of_surface.empty() || surface.shape.kind == SurfaceKind::kPlane || surface.shape.kind == SurfaceKind::kFree)
      continue;
    if (is_nearly_flat(facets, graph, of_surface, surface.tolerance, check)) continue;
    double largest = 0;
    for (std::size_t d = 0; d < kTurnDirections; ++d) {
      counted.clear();
      double area = 0, with_neighbours = 0;
      for (const PatchId p : of_surface) {
        check();
        area += graph.area(p);
        if (!(turns[p.value][d] > 0)) continue;
        with_neighbours += graph.area(p);
        counted.push_back({turns[p.value][d], graph.area(p)});
      }
      if (!counted.empty() && with_neighbours >= kPartOfArea * area)
        largest = std::max(largest, median_turn(counted, control));
    }
    if (largest > 0) surface.facets_per_turn = 360 / (kDegreesOfRadian * largest);
  }
  for (RecognisedSurface& s : recognised.surfaces)
    if (s.whole.is_valid()) s.facets_per_turn = recognised.surfaces[s.whole].facets_per_turn;
}

}  // namespace remesh
