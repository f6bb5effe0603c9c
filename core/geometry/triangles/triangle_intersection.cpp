#include "core/geometry/triangles/triangle_intersection.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/stoppable.h"
#include "core/geometry/exact/predicates.h"
#include "core/geometry/exact/predicates_3d.h"

namespace remesh {
namespace {

using Corners = std::array<Vec3, 3>;
using Corners2d = std::array<Vec2, 3>;

/// The plane coordinates that remain when one axis is dropped.
Vec2 project(const Vec3& p, int axis) {
  return axis == 0 ? Vec2{p.y, p.z} : axis == 1 ? Vec2{p.z, p.x} : Vec2{p.x, p.y};
}
Corners2d project(const Corners& t, int axis) {
  return {project(t[0], axis), project(t[1], axis), project(t[2], axis)};
}
int orientation(const Corners2d& t) { return orient2d(t[0], t[1], t[2]); }

/// An axis along which the triangle does not lose its area: that of the largest component of its normal, as far as
/// rounding allows. Empty if the triangle has no area.
std::optional<int> projection_axis(const Corners& t) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  const int largest = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  for (int i = 0; i < 3; ++i) {
    const int axis = (largest + i) % 3;
    if (orientation(project(t, axis)) != 0) return axis;
  }
  return std::nullopt;
}

/// Returns whether the closed intervals between two pairs of points on one line overlap. On a line, the lexicographic
/// order is the order along it.
template <class Point>
bool do_overlap(const Point& p, const Point& q, const Point& r, const Point& s) {
  return std::max(std::min(p, q), std::min(r, s)) <= std::min(std::max(p, q), std::max(r, s));
}

/// Returns whether the closed segments pq and rs meet. Either may be a point.
bool do_segments_meet(Vec2 p, Vec2 q, Vec2 r, Vec2 s) {
  const int pq_r = orient2d(p, q, r), pq_s = orient2d(p, q, s);
  const int rs_p = orient2d(r, s, p), rs_q = orient2d(r, s, q);
  if (pq_r == 0 && pq_s == 0 && rs_p == 0 && rs_q == 0) return do_overlap(p, q, r, s);
  return pq_r * pq_s <= 0 && rs_p * rs_q <= 0;
}

bool do_segments_meet(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  // If the four points have a common plane, some three of them span it, unless all four are on one line.
  for (const Corners& t : {Corners{p, q, r}, Corners{p, q, s}, Corners{r, s, p}, Corners{r, s, q}})
    if (const auto axis = projection_axis(t))
      return orient3d(p, q, r, s) == 0 &&
             do_segments_meet(project(p, *axis), project(q, *axis), project(r, *axis), project(s, *axis));
  return do_overlap(p, q, r, s);
}

/// Returns whether the closed segment pq meets the triangle, which has area in the plane.
bool does_segment_meet(Vec2 p, Vec2 q, const Corners2d& t) {
  const int turn = orientation(t);
  bool is_inside = true;
  for (int i = 0; i < 3; ++i) {
    const Vec2 from = t[i], to = t[(i + 1) % 3];
    if (do_segments_meet(p, q, from, to)) return true;
    is_inside = is_inside && orient2d(from, to, p) == turn;
  }
  return is_inside;
}

/// Returns whether the closed segment pq meets the triangle. Either may have no extent.
bool does_segment_meet(const Vec3& p, const Vec3& q, const Corners& t) {
  const int side_p = orient3d(t[0], t[1], t[2], p), side_q = orient3d(t[0], t[1], t[2], q);
  if (side_p * side_q > 0) return false;
  if (side_p != 0 || side_q != 0) {
    // The line crosses the plane in one point. It is in the triangle unless the line passes some edges on one side and
    // others on the other side.
    const int sides[] = {orient3d(p, q, t[0], t[1]), orient3d(p, q, t[1], t[2]), orient3d(p, q, t[2], t[0])};
    const auto [least, greatest] = std::minmax_element(std::begin(sides), std::end(sides));
    return *least * *greatest >= 0;
  }
  if (const auto axis = projection_axis(t))
    return does_segment_meet(project(p, *axis), project(q, *axis), project(t, *axis));
  const auto [first, last] = std::minmax_element(t.begin(), t.end());
  return do_segments_meet(p, q, *first, *last);
}

/// Returns whether an edge of `a` has a line with `a` on one side and `b` on the other, so that the two meet only in
/// the shared corners. These come first in both. `a` must have area. If `b` has area, too, and the two meet only in the
/// shared corners, then one of the two has such an edge.
bool has_separating_edge(const Corners2d& a, const Corners2d& b, int shared) {
  const int turn = orientation(a);
  const auto is_beyond = [&](int i, int j) {
    for (int k = shared; k < 3; ++k) {
      const int side = orient2d(a[i], a[j], b[k]) * turn;
      if (side > 0) return false;
      if (side < 0) continue;
      // If one corner is shared, b may lie on the line beyond that corner, away from the edge.
      if (shared != 1) return false;
      const Vec2 common = a[0], other = i == 0 ? a[j] : a[i];
      if ((b[k] < common) == (other < common)) return false;
    }
    return true;
  };
  // Only edges that contain all shared corners are tried.
  if (is_beyond(0, 1)) return true;
  if (shared == 2) return false;
  return is_beyond(2, 0) || (shared == 0 && is_beyond(1, 2));
}

enum class Sides { kOneSide, kCoplanar, kBoth };

/// The position of the corners of `b` that are not shared, relative to the plane of `a`. kBoth includes touching.
Sides sides_of(const Corners& a, const Corners& b, int shared) {
  int least = 1, greatest = -1;
  for (int k = shared; k < 3; ++k) {
    const int side = orient3d(a[0], a[1], a[2], b[k]);
    least = std::min(least, side);
    greatest = std::max(greatest, side);
  }
  if (least * greatest > 0) return Sides::kOneSide;
  return least == 0 && greatest == 0 ? Sides::kCoplanar : Sides::kBoth;
}

/// Moves equal ids to the front of both lists, in the same order. Returns how many there are.
template <class List>
int align(List& a, List& b) {
  int shared = 0;
  for (int i = 0; i < static_cast<int>(a.size()); ++i)
    for (int j = shared; j < static_cast<int>(b.size()); ++j)
      if (a[i] == b[j]) {
        std::swap(a[shared], a[i]);
        std::swap(b[shared], b[j]);
        ++shared;
        break;
      }
  return shared;
}

Corners corners(const Triangle& t, std::span<const Vec3> positions) {
  return {positions[t[0].value], positions[t[1].value], positions[t[2].value]};
}
/// The places of one, two or three corners. The last corner fills the places of missing ones.
Corners corners(const std::vector<VertexId>& t, std::span<const Vec3> positions) {
  return {positions[t[0].value], positions[t[std::min<std::size_t>(1, t.size() - 1)].value], positions[t.back().value]};
}

std::vector<VertexId> distinct(const Triangle& t) {
  std::vector<VertexId> ids(t.begin(), t.end());
  sort_unique(ids);
  return ids;
}

/// Returns whether all corners of `b` that are not shared are certainly on one side of the plane of `a`, by
/// floating-point arithmetic alone. Then the two meet only in what they share, whether `b` has area or not. This is so
/// for most neighbours on a surface.
bool is_clearly_beyond(const Corners& a, const Corners& b, int shared) {
  if (shared == 3) return false;
  const int side = certain_orient3d(a[0], a[1], a[2], b[2]);
  for (int k = shared; k < 2; ++k)
    if (certain_orient3d(a[0], a[1], a[2], b[k]) != side) return false;
  return side != 0;
}

/// do_intersect for triangles that have area. `axis` is a projection axis of a.
bool do_proper_triangles_intersect(const Corners& a, const Corners& b, int shared, int axis) {
  if (shared == 3) return true;
  // Triangles that are apart in a projection are apart in space.
  const Corners2d flat_a = project(a, axis), flat_b = project(b, axis);
  if (has_separating_edge(flat_a, flat_b, shared)) return false;
  if (orientation(flat_b) != 0 && has_separating_edge(flat_b, flat_a, shared)) return false;

  const Sides sides_of_b = sides_of(a, b, shared);
  if (sides_of_b != Sides::kBoth) return sides_of_b == Sides::kCoplanar;
  if (sides_of(b, a, shared) == Sides::kOneSide) return false;
  // A ray from the shared corner leaves a triangle through the opposite edge.
  if (shared == 1) return does_segment_meet(a[1], a[2], b) || does_segment_meet(b[1], b[2], a);
  for (int i = 0; i < 3; ++i)
    if (does_segment_meet(a[i], a[(i + 1) % 3], b) || does_segment_meet(b[i], b[(i + 1) % 3], a)) return true;
  return false;
}

/// do_intersect for two triangles of which at least one has no area. This is rare, so the code is simple rather than
/// fast.
bool do_degenerate_triangles_intersect(const Triangle& f, const Triangle& g, std::span<const Vec3> positions) {
  std::vector<VertexId> a = distinct(f), b = distinct(g);
  const int shared = align(a, b);
  // One of the two is a shared corner or a shared edge, or both are the segment of the same three corners.
  if (shared == static_cast<int>(std::min(a.size(), b.size()))) return false;
  const Corners corners_a = corners(a, positions), corners_b = corners(b, positions);
  const bool has_a_area = projection_axis(corners_a).has_value(), has_b_area = projection_axis(corners_b).has_value();

  if (shared == 0) {
    const auto [first, last] = std::minmax_element(has_a_area ? corners_b.begin() : corners_a.begin(),
                                                   has_a_area ? corners_b.end() : corners_a.end());
    return does_segment_meet(*first, *last, has_a_area ? corners_a : corners_b);
  }
  if (shared == 1) {
    // A ray from the shared corner leaves a triangle through the opposite edge. If the shared corner lies within that
    // edge, the ray leaves at the edge's ends.
    const auto does_exit_meet = [](const Corners& t, const Corners& other) {
      if (!do_segments_meet(t[0], t[0], t[1], t[2])) return does_segment_meet(t[1], t[2], other);
      return does_segment_meet(t[1], t[1], other) || does_segment_meet(t[2], t[2], other);
    };
    return does_exit_meet(corners_a, corners_b) || does_exit_meet(corners_b, corners_a);
  }
  // The triangles intersect if both continue along the line of the shared edge, beyond the same end of it.
  if (has_a_area || has_b_area) return false;
  const auto [first, last] = std::minmax(corners_a[0], corners_a[1]);
  const Vec3 &apex_a = corners_a[2], &apex_b = corners_b[2];
  return (apex_a < first && apex_b < first) || (apex_a > last && apex_b > last);
}

}  // namespace

bool do_intersect(const Triangle& f, const Triangle& g, std::span<const Vec3> positions) {
  Triangle a = f, b = g;
  const int shared = align(a, b);
  const Corners corners_a = corners(a, positions), corners_b = corners(b, positions);
  if (is_clearly_beyond(corners_a, corners_b, shared) || is_clearly_beyond(corners_b, corners_a, shared)) return false;
  const auto axis = projection_axis(corners_a);
  if (!axis || !projection_axis(corners_b)) return do_degenerate_triangles_intersect(f, g, positions);
  return do_proper_triangles_intersect(corners_a, corners_b, shared, *axis);
}

}  // namespace remesh
