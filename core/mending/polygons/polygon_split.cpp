#include "core/mending/polygons/polygon_split.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/planes/projection.h"
#include "core/triangulation/patch_triangulation.h"

namespace remesh {
namespace {

/// Returns whether all corners turn left, strictly.
bool is_convex(std::span<const Vec2> uv) {
  for (std::size_t i = 0; i < uv.size(); ++i)
    if (orient2d(uv[i], uv[(i + 1) % uv.size()], uv[(i + 2) % uv.size()]) <= 0) return false;
  return true;
}

/// Returns twice the area that the fan of triangles from a corner covers.
double covered_by_fan(std::span<const Vec3> points, std::size_t apex) {
  const std::size_t n = points.size();
  double twice = 0;
  for (std::size_t i = 1; i + 1 < n; ++i)
    twice += norm(cross(points[(apex + i) % n] - points[apex], points[(apex + i + 1) % n] - points[apex]));
  return twice;
}

/// Returns the corner from which a fan stands for a polygon that crosses itself: the lexicographically smallest one. If
/// a fan from another corner covers less than half as much, that corner is better: triangles of the first fan lie upon
/// each other and cover places outside the polygon, for example if the polygon is little more than two spikes.
std::uint32_t apex_of_fan(std::span<const Vec3> points) {
  constexpr std::size_t kMaxCorners = 64;  // looking at all fans takes the square of this
  const auto smallest = static_cast<std::size_t>(std::min_element(points.begin(), points.end()) - points.begin());
  if (points.size() > kMaxCorners) return static_cast<std::uint32_t>(smallest);
  std::size_t best = smallest;
  const double usual = covered_by_fan(points, smallest);
  double least = usual;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double covered = covered_by_fan(points, i);
    if (covered < least || (covered == least && points[i] < points[best])) {
      least = covered;
      best = i;
    }
  }
  return static_cast<std::uint32_t>(2 * least < usual ? best : smallest);
}

void fan(std::span<const Vec3> points, PolygonSplit& result) {
  const auto n = static_cast<std::uint32_t>(points.size());
  const std::uint32_t apex = apex_of_fan(points);
  for (std::uint32_t i = 1; i + 1 < n; ++i) result.triangles.push_back({apex, (apex + i) % n, (apex + i + 1) % n});
}

/// The place where the lexicographically smallest rotation of a cyclic sequence of n items begins.
/// Cost: O(n).
/// Source: Shiloach, Fast canonization of circular strings, Journal of Algorithms 2 (1981).
template <class At>
std::size_t least_rotation(std::size_t n, const At& at, RunControl& control) {
  StopCheck check(control);
  std::size_t i = 0, j = 1, equal = 0;
  while (i < n && j < n && equal < n) {
    check();
    const Vec3 &a = at((i + equal) % n), &b = at((j + equal) % n);
    if (a == b) {
      ++equal;
      continue;
    }
    (b < a ? i : j) += equal + 1;
    if (i == j) ++j;
    equal = 0;
  }
  return std::min(i, j);
}

/// A polygon's corners in an order that depends on its points alone, not on where the loop begins or which way it runs.
struct CanonicalLoop {
  std::vector<std::uint32_t> corners;
  bool is_reversed = false;
};

CanonicalLoop canonical_loop(std::span<const Vec3> points, RunControl& control) {
  const std::size_t n = points.size();
  const auto last = static_cast<std::uint32_t>(n - 1);
  const std::size_t first = least_rotation(
      n, [&](std::size_t i) -> const Vec3& { return points[i]; }, control);
  const std::size_t first_back = least_rotation(
      n, [&](std::size_t i) -> const Vec3& { return points[last - i]; }, control);
  CanonicalLoop loop;
  StopCheck check(control);
  for (std::size_t i = 0; i < n; ++i) {
    check();
    const Vec3 &ahead = points[(first + i) % n], &back = points[last - (first_back + i) % n];
    if (ahead == back) continue;
    loop.is_reversed = back < ahead;
    break;
  }
  for (std::size_t i = 0; i < n; ++i) {
    check();
    loop.corners.push_back(loop.is_reversed ? last - static_cast<std::uint32_t>((first_back + i) % n)
                                            : static_cast<std::uint32_t>((first + i) % n));
  }
  return loop;
}

/// Splits a polygon that has no spikes.
/// Input:  a polygon without spikes; reversals are allowed.
PolygonSplit split_outline(std::span<const Vec3> points, double plane_tolerance, RunControl& control) {
  const auto n = static_cast<std::uint32_t>(points.size());
  PolygonSplit result;
  if (n < 3) {
    result.kind = PolygonKind::kSelfCrossing;
    return result;
  }
  if (n == 3) {
    result.triangles = {{0, 1, 2}};
    return result;
  }
  const Vec3 normal = normalized(newell_normal(points));
  if (normal == Vec3{}) {
    result.kind = PolygonKind::kSelfCrossing;
    fan(points, result);
    return result;
  }
  Vec3 centre;
  for (const Vec3& p : points) centre += (1.0 / n) * p;
  double deviation = 0;
  for (const Vec3& p : points) deviation = std::max(deviation, std::fabs(dot(p - centre, normal)));
  const bool is_flat = deviation <= plane_tolerance;

  const std::vector<Vec2> uv = lay_out_polygon(points, centre, normal, control);
  StopCheck check(control);
  if (n == 4 && is_convex(uv)) {
    result.kind = is_flat ? PolygonKind::kPlanar : PolygonKind::kNotPlanar;
    result.has_two_ways = true;
    if (in_circle_perturbed(uv[0], uv[1], uv[2], uv[3]) > 0)
      result.triangles = {{0, 1, 3}, {1, 2, 3}};
    else
      result.triangles = {{0, 1, 2}, {0, 2, 3}};
    return result;
  }

  // Corners that meet in space (such as the ends of a bridge) are one point of the triangulation.
  std::vector<std::uint32_t> order(n), point_of(n);
  std::iota(order.begin(), order.end(), 0u);
  sort_stoppable(order.begin(), order.end(), control, [&](std::uint32_t a, std::uint32_t b) {
    return uv[a] != uv[b] ? uv[a] < uv[b] : points[a] != points[b] ? points[a] < points[b] : a < b;
  });
  std::vector<Vec2> plane_points;
  std::vector<std::uint32_t> corner_of_point;
  bool is_merged = false;
  for (std::uint32_t k = 0; k < n; ++k) {
    check();
    const std::uint32_t i = order[k];
    if (k == 0 || uv[i] != uv[order[k - 1]]) {
      plane_points.push_back(uv[i]);
      corner_of_point.push_back(i);
    } else if (points[i] != points[order[k - 1]]) {
      is_merged = true;  // different points in space have the same place in the plane: one lies above the other
    }
    point_of[i] = static_cast<std::uint32_t>(plane_points.size() - 1);
  }
  PatchTriangulation inside;
  inside.outcome = TriangulationOutcome::kCrossingConstraints;
  if (!is_merged) {
    std::vector<Segment> segments(n);
    for (std::uint32_t i = 0; i < n; ++i) segments[i] = {point_of[i], point_of[(i + 1) % n]};
    inside = triangulate_patch(plane_points, segments, control);
  }
  if (inside.outcome != TriangulationOutcome::kDone || inside.mesh.triangle_count() == 0) {
    result.kind = PolygonKind::kSelfCrossing;
    fan(points, result);
  } else {
    result.kind = is_flat ? PolygonKind::kPlanar : PolygonKind::kNotPlanar;
    for (std::uint32_t h = 0; h < inside.mesh.half_edge_count(); h += 3)
      result.triangles.push_back({corner_of_point[inside.mesh.from(h)], corner_of_point[inside.mesh.from(h + 1)],
                                  corner_of_point[inside.mesh.from(h + 2)]});
  }
  return result;
}

/// Splits the rest of a polygon after these spikes have been cut off.
PolygonSplit split_without(Spikes spikes, std::span<const Vec3> points, double plane_tolerance, RunControl& control) {
  if (spikes.needles.empty()) return split_outline(points, plane_tolerance, control);
  std::vector<Vec3> outline;
  outline.reserve(spikes.outline.size());
  for (const std::uint32_t i : spikes.outline) outline.push_back(points[i]);
  PolygonSplit result = split_outline(outline, plane_tolerance, control);
  for (auto& triangle : result.triangles)
    for (std::uint32_t& corner : triangle) corner = spikes.outline[corner];
  result.spikes = std::move(spikes);
  return result;
}

/// The tolerance with which spikes are looked for. If a polygon is hardly higher than the tolerance, all of its corners
/// would be tips, so only its exact spikes count.
double usable_tolerance(std::span<const Vec3> points, double spike_tolerance) {
  constexpr double kThin = 2 * kThinFace;
  Box3 box;
  for (const Vec3& p : points) box.add(p);
  return norm(newell_normal(points)) > kThin * spike_tolerance * box.diagonal() ? spike_tolerance : 0;
}

PolygonSplit split_canonical(std::span<const Vec3> points, const PolygonTolerances& tolerances, RunControl& control) {
  const double tolerance = usable_tolerance(points, tolerances.spikes);
  const auto without = [&](Spikes spikes) {
    PolygonSplit result = split_without(std::move(spikes), points, tolerances.plane, control);
    result.spike_tolerance = tolerance;
    return result;
  };
  Spikes all = cut_spikes(points, tolerance, Reversals::kCut, control);
  if (all.needles.empty()) return without({});
  // A polygon that has only slits stays as it is, because cutting off a narrow slit would close it.
  const bool has_slits_alone =
      tolerance > 0 && cut_spikes(points, tolerance, Reversals::kKeepSlits, control).needles.empty();
  PolygonSplit result = without(has_slits_alone ? Spikes() : cut_spikes(points, tolerance, Reversals::kKeep, control));
  if (result.kind == PolygonKind::kPlanar) return result;
  // A part that sticks out of the plane is no slit. Seen from above, a spike may look like one.
  PlaneSpikes in_space = cut_spikes_out_of_plane(points, tolerance, tolerances.plane, control);
  if (result.kind == PolygonKind::kNotPlanar && !in_space.has_left_plane) return result;
  if (has_slits_alone || in_space.has_left_plane) {
    result = without(std::move(in_space.spikes));
    if (result.kind != PolygonKind::kSelfCrossing) return result;
  }
  return all.needles.size() == result.spikes.needles.size() ? result : without(std::move(all));
}

}  // namespace

PolygonSplit split_polygon(std::span<const Vec3> points, const PolygonTolerances& tolerances, RunControl& control) {
  const CanonicalLoop loop = canonical_loop(points, control);
  std::vector<Vec3> canonical;
  canonical.reserve(points.size());
  for (const std::uint32_t i : loop.corners) canonical.push_back(points[i]);
  PolygonSplit result = split_canonical(canonical, tolerances, control);
  const auto as_given = [&](std::array<std::uint32_t, 3>& triangle) {
    for (std::uint32_t& corner : triangle) corner = loop.corners[corner];
  };
  for (auto& triangle : result.triangles) {
    as_given(triangle);
    if (loop.is_reversed) std::swap(triangle[1], triangle[2]);
  }
  for (auto& needle : result.spikes.needles) {
    as_given(needle);
    if (loop.is_reversed) std::swap(needle[0], needle[2]);
  }
  for (std::uint32_t& corner : result.spikes.outline) corner = loop.corners[corner];
  std::sort(result.spikes.outline.begin(), result.spikes.outline.end());
  return result;
}

}  // namespace remesh
