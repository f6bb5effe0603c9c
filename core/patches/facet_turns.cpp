#include "core/patches/facet_turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/grouping.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

constexpr double kDegreesOfRadian = 180 / std::numbers::pi;
constexpr double kFullTurnOfFacets = 2 * std::numbers::pi;

/// A neighbour lies beside a facet in a direction if its middle is that part of the facet's width away.
constexpr double kPartOfWidth = 0.25;
/// A direction counts if facets of this part of the area have neighbours in it.
constexpr double kPartOfArea = 0.1;

/// An interval of angles.
struct AngleRange {
  double middle = 0, width = 0;

  /// Returns the angle between the middles of two intervals, 0 to half a turn.
  double from(const AngleRange& other) const {
    return std::fabs(std::remainder(middle - other.middle, kFullTurnOfFacets));
  }
};

/// The directions in which facets have neighbours: around the axis, and across that.
constexpr std::size_t kAroundAxis = 0, kAcrossAxis = 1, kTurnDirections = 2;

/// By how much the surface turns from a facet to its neighbours in each direction. 0 stands for no neighbour.
using FacetTurn = std::array<double, kTurnDirections>;

/// Measures facets one by one. All lengths are in model units.
class TurnMeasure {
 public:
  TurnMeasure(const Facets& facets, const FacetGraph& graph, const RecognisedSurfaces& recognised)
      : facets_(facets), graph_(graph), recognised_(recognised) {}

  FacetTurn turn_of(PatchId p) const {
    const SurfaceKind kind = surface_of(p).shape.kind;
    if (kind == SurfaceKind::kPlane || kind == SurfaceKind::kFree || !graph_.may_be_seed(p)) return {};
    return kind == SurfaceKind::kSphere ? on_sphere(p) : around_axis(p);
  }

 private:
  using Ranges = std::array<AngleRange, kTurnDirections>;

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
    const Vec3& axis = shape.axis;
    const double ax = std::fabs(axis.x), ay = std::fabs(axis.y), az = std::fabs(axis.z);
    const Vec3 x = normalized(cross(axis, ax <= ay && ax <= az ? Vec3{1, 0, 0}
                                          : ay <= az           ? Vec3{0, 1, 0}
                                                               : Vec3{0, 0, 1}));
    const Vec3 y = cross(axis, x);
    std::array<double, kTurnDirections> first{}, low{}, high{};
    std::array<bool, kTurnDirections> is_any{};
    const auto add = [&](std::size_t d, double angle) {
      if (!is_any[d]) first[d] = angle;
      is_any[d] = true;
      const double way = std::remainder(angle - first[d], kFullTurnOfFacets);
      low[d] = std::min(low[d], way);
      high[d] = std::max(high[d], way);
    };
    const auto radius_of = [&](const Vec3& q) { return std::hypot(dot(q, x), dot(q, y)); };
    double largest = 0;
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s)
      largest = std::max(largest, radius_of(corner(s) - shape.origin));
    for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
      if (!graph_.is_corner(s)) continue;
      const Vec3 q = corner(s) - shape.origin;
      const double radius = radius_of(q);
      // Near the axis, as at the apex of a cone, rounding alone decides the angle.
      constexpr double kNearAxis = 0.25;
      if (radius > kNearAxis * largest) add(kAroundAxis, std::atan2(dot(q, y), dot(q, x)));
      if (shape.kind == SurfaceKind::kTorus) add(kAcrossAxis, std::atan2(dot(q, axis), radius - shape.radius));
    }
    Ranges ranges;
    for (std::size_t d = 0; d < kTurnDirections; ++d)
      ranges[d] = {first[d] + 0.5 * (low[d] + high[d]), high[d] - low[d]};
    return ranges;
  }

  FacetTurn around_axis(PatchId p) const {
    const AnalyticSurface& shape = surface_of(p).shape;
    const Ranges own = ranges_of(p, shape);
    FacetTurn result{};
    graph_.for_each_neighbour(p, [&](PatchId q) {
      bool is_band = false;
      if (!is_same_surface(p, q, is_band) || !graph_.may_be_seed(q)) return;
      if (is_band) {
        const AnalyticSurface& beside = surface_of(q).shape;
        result[kAcrossAxis] = std::max(result[kAcrossAxis], std::fabs(slope(shape) - slope(beside)));
        return;
      }
      const Ranges other = ranges_of(q, shape);
      for (std::size_t d = 0; d < kTurnDirections; ++d)
        if (own[d].from(other[d]) > kPartOfWidth * std::min(own[d].width, other[d].width)) result[d] = own[d].width;
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
};

/// A turn, and the area for which it counts.
struct WeighedTurn {
  double turn, area;
  friend bool operator<(const WeighedTurn& a, const WeighedTurn& b) {
    return a.turn != b.turn ? a.turn < b.turn : a.area < b.area;
  }
};

/// Returns the turn that those of half of the area are below.
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

}  // namespace

void measure_turns(const Facets& facets, const FacetGraph& graph, RecognisedSurfaces& recognised, RunControl& control) {
  if (!graph.has_smooth_edges()) return;
  const TurnMeasure measure(facets, graph, recognised);
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
    double largest = 0;
    for (std::size_t d = 0; d < kTurnDirections; ++d) {
      counted.clear();
      double area = 0, with_neighbours = 0;
      for (std::uint32_t i = groups.begin[s]; i < groups.begin[s + 1]; ++i) {
        check();
        const PatchId p = groups.items[i];
        area += graph.area(p);
        if (!(turns[p.value][d] > 0)) continue;
        with_neighbours += graph.area(p);
        counted.push_back({turns[p.value][d], graph.area(p)});
      }
      if (!counted.empty() && with_neighbours >= kPartOfArea * area)
        largest = std::max(largest, median_turn(counted, control));
    }
    if (largest > 0) recognised.surfaces[SurfaceId(s)].facets_per_turn = 360 / (kDegreesOfRadian * largest);
  }
  for (RecognisedSurface& s : recognised.surfaces)
    if (s.whole.is_valid()) s.facets_per_turn = recognised.surfaces[s.whole].facets_per_turn;
}

}  // namespace remesh
