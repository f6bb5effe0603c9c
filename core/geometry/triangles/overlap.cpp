#include "core/geometry/triangles/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

using Corners = std::array<Vec3, 3>;

Corners corners_of(const Triangle& t, std::span<const Vec3> positions) {
  return {positions[t[0].value], positions[t[1].value], positions[t[2].value]};
}

/// Returns whether all of `b` is on or beyond the line of one of a's edges.
bool is_apart(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  const int turn = orient2d(a[0], a[1], a[2]);
  for (std::size_t i = 0; i < 3; ++i)
    if (std::all_of(b.begin(), b.end(), [&](Vec2 p) { return orient2d(a[i], a[(i + 1) % 3], p) * turn <= 0; }))
      return true;
  return false;
}

bool is_in_plane_of(const Corners& a, const Corners& b, double scale, double tolerance) {
  const Vec3 normal = normalized(cross(scale * (a[1] - a[0]), scale * (a[2] - a[0])));
  // Rounding moves exactly coplanar triangles by some units in the last place.
  constexpr double kRounding = 1e-12;
  return std::all_of(b.begin(), b.end(), [&](const Vec3& p) {
    return std::fabs(dot(normal, p - a[0])) <= tolerance + kRounding * norm(p - a[0]);
  });
}

}  // namespace

bool do_overlap(const Triangle& f, const Triangle& g, std::span<const Vec3> positions, double tolerance) {
  const Corners a = corners_of(f, positions), b = corners_of(g, positions);
  double largest = 0;
  for (const Corners* t : {&a, &b})
    for (const Vec3& p : *t) largest = std::max({largest, norm(p - a[0])});
  const double scale = largest > 0 ? std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1000, 1000)) : 1;
  if (!is_in_plane_of(a, b, scale, tolerance) || !is_in_plane_of(b, a, scale, tolerance)) return false;
  // Dropping an axis preserves lines. Dropping the axis along which the normal is longest preserves most of the area.
  const Vec3 n = cross(scale * (a[1] - a[0]), scale * (a[2] - a[0]));
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  const auto flat = [&](const Corners& t) {
    std::array<Vec2, 3> points;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = scale * (t[i] - a[0]);
      points[i] = x >= y && x >= z ? Vec2{p.y, p.z} : y >= z ? Vec2{p.z, p.x} : Vec2{p.x, p.y};
    }
    return points;
  };
  const auto flat_a = flat(a), flat_b = flat(b);
  if (orient2d(flat_a[0], flat_a[1], flat_a[2]) == 0 || orient2d(flat_b[0], flat_b[1], flat_b[2]) == 0) return false;
  return !is_apart(flat_a, flat_b) && !is_apart(flat_b, flat_a);
}

Vec3 meeting_place(const Triangle& f, const Triangle& g, std::span<const Vec3> positions) {
  Box3 a, b;
  for (const Vec3& p : corners_of(f, positions)) a.add(p);
  for (const Vec3& p : corners_of(g, positions)) b.add(p);
  Vec3 middle;
  for (int axis = 0; axis < 3; ++axis)
    middle[axis] = 0.5 * std::max(a.min[axis], b.min[axis]) + 0.5 * std::min(a.max[axis], b.max[axis]);
  return middle;
}

}  // namespace remesh
