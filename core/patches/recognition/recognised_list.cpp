#include "core/patches/recognition/recognised_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/geometry/surfaces/surface_fit.h"
#include "core/patches/recognition/explained_height.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/facet_turns.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {
namespace {

/// Measures of facets, relative to their surface.
struct FacetMeasures {
  double chord_height = 0;  ///< largest distance of the facets from the surface, at their sides and in their middles
  double explained = 0;     ///< the largest explained_height of a facet; 0 for surfaces of revolution
  double turn_deg = 0;      ///< largest angle by which the surface turns along a side
  double sweep_deg = 0;     ///< how much of a full turn around the axis they cover; 0 for spheres, which have no axis
};

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kDegrees = 180 / std::numbers::pi;

/// A place around an axis.
struct Place {
  Vec2 across;       ///< relative to the axis
  double order = 0;  ///< ascends with the angle, from 0 to 4
  bool is_on_axis = false;
};

/// Angles around an axis that facets cover.
class Sweep {
 public:
  Sweep(const AnalyticSurface& shape, double tolerance)
      : shape_(shape), tolerance_(tolerance), x_(unit_across(shape.axis)), y_(cross(shape.axis, x_)) {}

  Place place_of(const Vec3& p) const {
    const Vec3 q = p - shape_.origin;
    const Vec2 at{dot(q, x_), dot(q, y_)};
    const double size = std::fabs(at.x) + std::fabs(at.y);
    if (!(size > tolerance_)) return {at, 0, true};
    const double part = at.x / size;
    return {at, at.y >= 0 ? 1 - part : 3 + part, false};
  }

  /// Adds the angles between the ends of a side. A side that ends on the axis, or that runs along it, covers none.
  void add(const Place& a, const Place& b) {
    if (a.is_on_axis || b.is_on_axis) return;
    const double turn = cross(a.across, b.across);
    if (std::fabs(turn) <= 1e-12 * (dot(a.across, a.across) + dot(b.across, b.across))) return;
    const Place &from = turn > 0 ? a : b, &to = turn > 0 ? b : a;
    covered_.push_back({from.order, to.order});
    if (from.order > to.order) {
      covered_.back().second = kFull;
      covered_.push_back({0, to.order});
    }
  }

  /// Returns the angle that is covered, in degrees.
  double degrees(RunControl& control) {
    sort_stoppable(covered_.begin(), covered_.end(), control);
    double gaps = 0, end = 0;
    const auto add_gap = [&](double to) {
      // Neighbouring sides meet, up to rounding.
      if (to > end + 1e-9) gaps += angle_at(to) - angle_at(end);
    };
    for (const auto& [from, to] : covered_) {
      add_gap(from);
      end = std::max(end, to);
    }
    add_gap(kFull);
    return std::clamp(kDegrees * (kTurn - gaps), 0.0, 360.0);
  }

 private:
  static constexpr double kFull = 4;  ///< the order at the end of a full turn

  static double angle_at(double order) {
    if (order >= kFull) return kTurn;
    const double part = order <= 2 ? 1 - order : order - 3;
    const double angle = std::atan2(1 - std::fabs(part), part);
    return order <= 2 ? angle : kTurn - angle;
  }

  const AnalyticSurface& shape_;
  double tolerance_;
  Vec3 x_, y_;
  std::vector<std::pair<double, double>> covered_;
};

/// Returns how far the middle of a side is inside of a surface of revolution. Only sides that run around the axis have
/// such a distance.
double ring_height(const AnalyticSurface& shape, const Vec3& a, const Vec3& b, double tolerance) {
  const auto radius = [&](const Vec3& p) {
    const Vec3 q = p - shape.origin;
    return norm(q - dot(q, shape.axis) * shape.axis);
  };
  if (std::fabs(dot(b - a, shape.axis)) > tolerance) return 0;
  return std::fabs(0.5 * (radius(a) + radius(b)) - radius(0.5 * (a + b)));
}

/// Returns the normal of the surface at a corner. For a surface of revolution, returns the direction away from the
/// axis, which shows only the turn around the axis.
Vec3 normal_at(const AnalyticSurface& shape, const Vec3& p) {
  if (shape.kind != SurfaceKind::kRevolution) return shape.normal(p);
  const Vec3 q = p - shape.origin;
  return normalized(q - dot(q, shape.axis) * shape.axis);
}

/// Measures the facets of a claim. Corners within `tolerance` of the axis have no angle around it. All lengths are in
/// local units.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n) in the facets.
FacetMeasures measure_facets(const FacetGraph& graph, const SurfaceClaim& claim, const AnalyticSurface& shape,
                             double tolerance, RunControl& control) {
  const bool is_revolution = shape.kind == SurfaceKind::kRevolution;
  FacetMeasures result;
  Sweep sweep(shape, tolerance);
  StopCheck check(control);
  std::vector<Vec3> corners;
  double min_cosine = 1;
  for (const PatchId p : claim.facets) {
    check();
    Vec3 last, last_normal;
    corners.clear();
    Place last_place;
    int count = 0;
    graph.for_each_side(p, [&](const Vec3& a, const Vec3& b, bool is_corner) {
      const double height =
          is_revolution ? ring_height(shape, a, b, tolerance) : std::fabs(shape.distance(0.5 * (a + b)));
      result.chord_height = std::max(result.chord_height, height);
      if (!is_corner && !is_revolution)
        result.chord_height = std::max(result.chord_height, std::fabs(shape.distance(a)));
      // Most sides begin where the one before them ends.
      const bool is_next = count > 0 && a == last;
      const Vec3 n = is_next ? last_normal : normal_at(shape, a), m = normal_at(shape, b);
      if (norm_squared(n) > 0 && norm_squared(m) > 0) min_cosine = std::min(min_cosine, dot(n, m));
      if (shape.kind != SurfaceKind::kSphere) {
        const Place end = sweep.place_of(b);
        sweep.add(is_next ? last_place : sweep.place_of(a), end);
        last_place = end;
      }
      last_normal = m;
      last = b;
      if (is_corner) corners.push_back(a);
      ++count;
    });
    // The middle of a ring does not lie on the ring.
    if (!graph.may_be_seed(p) || is_revolution) continue;
    result.explained = std::max(result.explained, explained_height(graph, shape, p));
    // The sum comes in an order that depends on the corners alone.
    std::sort(corners.begin(), corners.end());
    Vec3 sum;
    for (const Vec3& corner : corners) sum += corner;
    const Vec3 middle = (1.0 / static_cast<double>(corners.size())) * sum;
    result.chord_height = std::max(result.chord_height, std::fabs(shape.distance(middle)));
  }
  result.turn_deg = kDegrees * std::acos(std::clamp(min_cosine, -1.0, 1.0));
  if (shape.kind != SurfaceKind::kSphere) result.sweep_deg = sweep.degrees(control);
  return result;
}

/// A free region has at least this many facets. Fewer facets that meet smoothly count as planes.
constexpr std::size_t kMinFreeFacets = 12;

/// A facet of a free region is a plane if its area is this many times the median.
constexpr double kFlatArea = 20;

/// The best kind is determined for at most this many free regions, each by at most this many corners.
constexpr std::size_t kMaxExplained = 64, kMaxSamples = 256;

/// Makes the records.
/// This class is larger than the bound because it has a short function for each kind of record.
class Records {
 public:
  Records(const Facets& facets, const FacetGraph& graph, const RecognitionRules& rules, RunControl& control)
      : facets_(facets), graph_(graph), rules_(rules), control_(control), check_(control) {
    result_.of_patch.assign(graph.size(), SurfaceId());
  }

  RecognisedSurfaces make(std::vector<SurfaceClaim> claims) {
    join_equal(claims);
    for (SurfaceClaim& claim : claims) add_claim(claim);
    add_free_regions();
    add_planes();
    sort_few();
    return std::move(result_);
  }

 private:
  double unit() const { return facets_.surface.unit; }
  double tolerance() const { return rules_.tolerance / unit(); }
  Vec3 in_model(const Vec3& local) const { return facets_.surface.centre + unit() * local; }

  /// Returns numbers that are about equal for equal surfaces.
  std::array<double, 8> key_of(const SurfaceClaim& claim) const {
    const AnalyticSurface& s = claim.shape;
    const Vec3 axis = s.kind == SurfaceKind::kCone ? s.axis : canonical_direction(s.axis);
    const Vec3 place = s.kind == SurfaceKind::kCylinder ? s.origin - dot(s.origin, axis) * axis : s.origin;
    return {s.radius + s.half_angle, s.minor_radius, axis.x, axis.y, axis.z, place.x, place.y, place.z};
  }

  std::vector<Vec3> corners_of(std::span<const PatchId> facets) {
    std::vector<VertexId> vertices;
    for (const PatchId p : facets)
      for (std::uint32_t s = graph_.sides_begin(p); s < graph_.sides_end(p); ++s) {
        check_();
        if (graph_.is_corner(s)) vertices.push_back(graph_.vertex(s));
      }
    sort_unique(vertices, control_);
    std::vector<Vec3> points;
    points.reserve(vertices.size());
    for (const VertexId v : vertices) points.push_back(graph_.position(v));
    sort_stoppable(points.begin(), points.end(), control_);
    return points;
  }

  /// Joins claims for equal surfaces into one.
  void join_equal(std::vector<SurfaceClaim>& claims) {
    struct Keyed {
      SurfaceKind kind;
      std::array<double, 8> key;
      std::uint32_t claim;
    };
    std::vector<Keyed> keys;
    for (std::uint32_t c = 0; c < claims.size(); ++c) keys.push_back({claims[c].shape.kind, key_of(claims[c]), c});
    std::stable_sort(keys.begin(), keys.end(), [](const Keyed& a, const Keyed& b) { return a.kind < b.kind; });
    for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
      while (end < keys.size() && keys[end].kind == keys[begin].kind) ++end;
      join_within(claims, std::span(keys).subspan(begin, end - begin), 0);
    }
    std::erase_if(claims, [](const SurfaceClaim& c) { return c.facets.empty(); });
  }

  /// Splits a list at gaps of the i-th number, and continues each part with the next number.
  template <class Keyed>
  void join_within(std::vector<SurfaceClaim>& claims, std::span<Keyed> keys, std::size_t i) {
    constexpr double kGap = 1e-4;
    if (keys.size() < 2) return;
    if (i == 8) return join(claims, keys);
    std::stable_sort(keys.begin(), keys.end(), [&](const Keyed& a, const Keyed& b) { return a.key[i] < b.key[i]; });
    for (std::size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
      end = begin + 1;
      while (end < keys.size() && keys[end].key[i] - keys[end - 1].key[i] <= kGap) ++end;
      join_within(claims, keys.subspan(begin, end - begin), i + 1);
    }
  }

  /// Joins the equal claims among some claims.
  template <class Keyed>
  void join(std::vector<SurfaceClaim>& claims, std::span<Keyed> keys) {
    // Each claim is compared with at most this many others, so that the work is in proportion.
    constexpr std::size_t kMaxCompared = 16;
    // The order is from large to small. Ties are broken by the place.
    std::sort(keys.begin(), keys.end(), [&](const Keyed& a, const Keyed& b) {
      const SurfaceClaim &c = claims[a.claim], &d = claims[b.claim];
      return c.area != d.area ? c.area > d.area : a.key < b.key;
    });
    std::vector<std::uint32_t> left;
    for (const Keyed& key : keys) left.push_back(key.claim);
    for (std::size_t k = 0; k < kMaxCompared && left.size() > 1; ++k) join_to_first(claims, left);
  }

  /// Joins the claims of a list that are equal to its first one with that one. They are joined all at once, so that no
  /// corner is tested more than a few times. Removes the joined claims from the list.
  void join_to_first(std::vector<SurfaceClaim>& claims, std::vector<std::uint32_t>& left) {
    SurfaceClaim& first = claims[left.front()];
    left.erase(left.begin());
    if (first.shape.kind == SurfaceKind::kRevolution) return;
    // A surface of few facets may be less exact outside of them.
    constexpr double kNear = 20;
    const auto deviation_from = [&](const AnalyticSurface& s, std::span<const Vec3> points) {
      double deviation = 0;
      for (const Vec3& p : points) deviation = std::max(deviation, std::fabs(s.distance(p)));
      return deviation;
    };
    const std::vector<Vec3> of_first = corners_of(first.facets);
    const auto some = std::span(of_first).first(std::min(of_first.size(), kMaxSamples));
    std::vector<std::uint32_t> near;
    for (const std::uint32_t c : left) {
      const double tolerance = std::max(first.tolerance, claims[c].tolerance);
      const bool is_near = deviation_from(claims[c].shape, some) <= kNear * tolerance ||
                           deviation_from(first.shape, corners_of(claims[c].facets)) <= kNear * tolerance;
      if (is_near) near.push_back(c);
    }
    // Claims that do not fit the common surface are left out, and the others are tried again.
    constexpr int kMaxFits = 3;
    for (int fit = 0; fit < kMaxFits && !near.empty(); ++fit) {
      std::vector<PatchId> facets = first.facets;
      double tolerance = first.tolerance;
      for (const std::uint32_t c : near) {
        facets.insert(facets.end(), claims[c].facets.begin(), claims[c].facets.end());
        tolerance = std::max(tolerance, claims[c].tolerance);
      }
      const std::vector<Vec3> all = corners_of(facets);
      const auto about = fit_from(first.shape, all, {.control = &control_});
      const auto fitted = about ? fit_from(*about, all, {.is_canonical = true, .control = &control_}) : std::nullopt;
      if (!fitted) return;
      if (deviation_from(*fitted, all) <= tolerance)
        return take_in(first, claims, left, near, *fitted, std::move(facets));
      std::erase_if(near,
                    [&](std::uint32_t c) { return deviation_from(*fitted, corners_of(claims[c].facets)) > tolerance; });
    }
  }

  /// Gives the facets of some claims to the first one.
  static void take_in(SurfaceClaim& first, std::vector<SurfaceClaim>& claims, std::vector<std::uint32_t>& left,
                      std::span<const std::uint32_t> near, const AnalyticSurface& shape, std::vector<PatchId> facets) {
    first.shape = shape;
    first.facets = std::move(facets);
    for (const std::uint32_t c : near) {
      if (claims[c].side != first.side) first.side = 0;
      first.tolerance = std::max(first.tolerance, claims[c].tolerance);
      first.area += claims[c].area;
      claims[c].facets.clear();
    }
    std::erase_if(left, [&](std::uint32_t c) { return claims[c].facets.empty(); });
  }

  /// Adds the patches, faces, area and extent of some facets to a record.
  void add_facets(std::span<const PatchId> facets, SurfaceId id) {
    RecognisedSurface& record = result_.surfaces[id];
    std::vector<double> areas;
    for (const PatchId p : facets) {
      check_();
      result_.of_patch[p] = id;
      record.faces += facets_.summaries[p.value].input_faces;
      areas.push_back(facets_.summaries[p.value].area);
      graph_.for_each_corner(p, [&](const Vec3& q) { record.extent.add({in_model(q), in_model(q)}); });
    }
    record.patches += facets.size();
    // The sum comes in an order that depends on the areas alone.
    sort_stoppable(areas.begin(), areas.end(), control_);
    for (const double area : areas) record.area += area;
  }

  void add_claim(const SurfaceClaim& claim) {
    const SurfaceId id = add_surface(claim);
    // Bands may have lost facets since they were joined.
    for (SurfaceClaim band : claim.bands) {
      std::erase_if(band.facets, [&](PatchId p) { return result_.of_patch[p] != id; });
      if (!band.facets.empty()) result_.surfaces[add_surface(band)].whole = id;
    }
    // The patches belong to the bands.
    if (!claim.bands.empty()) result_.surfaces[id].patches = 0;
  }

  /// Makes the record of a claim, and gives the claim's facets to it.
  SurfaceId add_surface(const SurfaceClaim& claim) {
    AnalyticSurface shape = claim.shape;
    // A cone points away from its apex, and the heights of a profile go along the axis.
    if (shape.kind != SurfaceKind::kCone && shape.kind != SurfaceKind::kRevolution)
      shape.axis = canonical_direction(shape.axis);
    const std::vector<Vec3> corners = corners_of(claim.facets);
    if (shape.kind == SurfaceKind::kCylinder) {
      // The point of the axis lies in the middle of the facets.
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const Vec3& p : corners) {
        const double z = dot(p - shape.origin, shape.axis);
        low = std::min(low, z);
        high = std::max(high, z);
      }
      shape.origin += 0.5 * (low + high) * shape.axis;
    }
    RecognisedSurface record;
    const FacetMeasures measures = measure_facets(graph_, claim, shape, claim.tolerance, control_);
    record.input_chord_height = measures.chord_height * unit();
    record.explained_height = std::min(measures.explained, measures.chord_height) * unit();
    record.input_turn_deg = measures.turn_deg;
    record.sweep_deg = measures.sweep_deg;
    for (const Vec2& p : claim.profile) record.profile.push_back(unit() * p);
    record.shape = {shape.kind,
                    in_model(shape.origin),
                    shape.kind == SurfaceKind::kSphere ? Vec3{} : shape.axis,
                    unit() * shape.radius,
                    unit() * shape.minor_radius,
                    shape.half_angle};
    record.tolerance = claim.tolerance * unit();
    if (shape.kind == SurfaceKind::kRevolution) record.deviation = claim.deviation;
    for (const Vec3& p : corners) record.deviation = std::max(record.deviation, std::fabs(shape.distance(p)));
    record.deviation *= unit();
    record.side = claim.side > 0 ? SurfaceSide::kConvex : claim.side < 0 ? SurfaceSide::kConcave : SurfaceSide::kBoth;
    const SurfaceId id = result_.surfaces.push_back(std::move(record));
    add_facets(claim.facets, id);
    return id;
  }

  /// Finds the free regions among the facets that belong to no claim.
  void add_free_regions() {
    std::vector<PatchId> region;
    std::vector<std::pair<double, std::vector<PatchId>>> regions;
    IdVector<PatchId, std::uint8_t> is_visited(graph_.size(), 0);
    const auto is_free = [&](PatchId p) { return !result_.of_patch[p].is_valid() && graph_.may_be_curved(p); };
    for (std::size_t i = 0; i < graph_.size(); ++i) {
      const PatchId first(i);
      if (!is_free(first) || is_visited[first] != 0) continue;
      region.assign({first});
      is_visited[first] = 1;
      for (std::size_t k = 0; k < region.size(); ++k)
        graph_.for_each_neighbour(region[k], [&](PatchId q) {
          check_();
          if (!is_free(q) || is_visited[q] != 0) return;
          is_visited[q] = 1;
          region.push_back(q);
        });
      drop_flat(region);
      if (region.size() < kMinFreeFacets) continue;
      double area = 0;
      for (const PatchId p : region) area += graph_.area(p);
      regions.push_back({area, region});
    }
    std::stable_sort(regions.begin(), regions.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (std::size_t i = 0; i < regions.size(); ++i) {
      RecognisedSurface record;
      record.reason = FreeReason::kNoKindFits;
      if (i < kMaxExplained) explain(regions[i].second, record);
      add_facets(regions[i].second, result_.surfaces.push_back(std::move(record)));
    }
  }

  /// Removes facets from a region that are much larger than its median facet.
  void drop_flat(std::vector<PatchId>& region) const {
    if (region.size() < kMinFreeFacets) return;
    std::vector<double> areas;
    for (const PatchId p : region) areas.push_back(graph_.area(p));
    auto middle = areas.begin() + static_cast<std::ptrdiff_t>(areas.size() / 2);
    std::nth_element(areas.begin(), middle, areas.end());
    std::erase_if(region, [&](PatchId p) { return graph_.area(p) > kFlatArea * *middle; });
  }

  /// Finds the kind that comes nearest to a free region.
  void explain(std::span<const PatchId> region, RecognisedSurface& record) {
    const std::size_t step = (region.size() + kMaxSamples - 1) / kMaxSamples;
    std::vector<PatchId> chosen;
    for (std::size_t i = 0; i < region.size(); i += step) chosen.push_back(region[i]);
    const std::vector<Vec3> corners = corners_of(chosen);
    std::vector<FacetPlace> places;
    for (const PatchId p : chosen) {
      Vec3 sum;
      int count = 0;
      graph_.for_each_corner(p, [&](const Vec3& q) {
        sum += q;
        ++count;
      });
      places.push_back({(1.0 / count) * sum, graph_.normal(p)});
    }
    double best = HUGE_VAL;
    const auto attempt = [&](const std::optional<AnalyticSurface>& guess) {
      const auto fitted = guess ? fit_from(*guess, corners) : std::nullopt;
      if (!fitted) return;
      double deviation = 0;
      for (const Vec3& p : corners) deviation = std::max(deviation, std::fabs(fitted->distance(p)));
      if (!(deviation < best)) return;
      best = deviation;
      record.nearest_kind = fitted->kind;
      record.nearest_deviation = deviation * unit();
    };
    attempt(guess_sphere(corners));
    attempt(guess_cylinder(corners, places));
    attempt(guess_cone(corners, places));
    attempt(guess_torus(corners, places));
    if (!(best <= tolerance())) return;
    // A kind fits, but no claim has the facets.
    record.reason = region.size() < 2 * kMinFreeFacets ? FreeReason::kFewFacets : FreeReason::kUnevenFacets;
  }

  /// Adds a plane for each remaining facet.
  void add_planes() {
    const auto left = std::count(result_.of_patch.begin(), result_.of_patch.end(), SurfaceId());
    result_.surfaces.reserve(result_.surfaces.size() + static_cast<std::size_t>(left));
    for (std::size_t i = 0; i < graph_.size(); ++i) {
      check_();
      const PatchId p(i);
      if (result_.of_patch[p].is_valid()) continue;
      const PatchSummary& patch = facets_.summaries[i];
      RecognisedSurface plane;
      plane.shape = {SurfaceKind::kPlane, patch.offset * patch.normal, patch.normal, 0, 0, 0};
      plane.tolerance = rules_.tolerance;
      plane.deviation = patch.deviation;
      plane.patches = 1;
      plane.faces = patch.input_faces;
      plane.area = patch.area;
      graph_.for_each_corner(p, [&](const Vec3& q) { plane.extent.add({in_model(q), in_model(q)}); });
      result_.of_patch[p] = result_.surfaces.push_back(std::move(plane));
    }
  }

  /// Numbers the surfaces by kind, and from large to small. Bands come last.
  void sort_few() {
    std::vector<std::uint32_t> order(result_.surfaces.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    sort_stoppable(order.begin(), order.end(), control_, [&](std::uint32_t i, std::uint32_t j) {
      const RecognisedSurface &a = result_.surfaces[SurfaceId(i)], &b = result_.surfaces[SurfaceId(j)];
      if (a.whole.is_valid() != b.whole.is_valid()) return b.whole.is_valid();
      if (a.shape.kind != b.shape.kind) return a.shape.kind < b.shape.kind;
      // Sums of areas differ in their last bits with the order of faces.
      const auto area_of = [](const RecognisedSurface& s) { return static_cast<float>(s.area); };
      if (area_of(a) != area_of(b)) return area_of(a) > area_of(b);
      if (a.extent.min != b.extent.min) return a.extent.min < b.extent.min;
      if (a.extent.max != b.extent.max) return a.extent.max < b.extent.max;
      return i < j;
    });
    std::vector<SurfaceId> now(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) now[order[i]] = SurfaceId(i);
    // A record is large, so there is only one list of them. Each cycle of the permutation is gone through once.
    for (std::uint32_t i = 0; i < order.size(); ++i) {
      check_();
      RecognisedSurface first = std::move(result_.surfaces[SurfaceId(i)]);
      std::uint32_t at = i;
      while (order[at] != i) {
        check_();
        const std::uint32_t from = std::exchange(order[at], at);
        result_.surfaces[SurfaceId(at)] = std::move(result_.surfaces[SurfaceId(from)]);
        at = from;
      }
      order[at] = at;
      result_.surfaces[SurfaceId(at)] = std::move(first);
    }
    for (SurfaceId& s : result_.of_patch) s = now[s.value];
    for (RecognisedSurface& s : result_.surfaces)
      if (s.whole.is_valid()) s.whole = now[s.whole.value];
  }

  const Facets& facets_;
  const FacetGraph& graph_;
  const RecognitionRules& rules_;
  RunControl& control_;
  StopCheck check_;
  RecognisedSurfaces result_;
};

}  // namespace

RecognisedSurfaces make_recognised_list(const Facets& facets, const FacetGraph& graph, std::vector<SurfaceClaim> claims,
                                        const RecognitionRules& rules, RunControl& control) {
  RecognisedSurfaces recognised = Records(facets, graph, rules, control).make(std::move(claims));
  measure_turns(facets, graph, recognised, control);
  return recognised;
}

}  // namespace remesh
