#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

/// The shortest vector between two segments if neither of its ends is an end of a segment; otherwise infinitely long.
Vec3 way_inside(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 ab = b - a, cd = d - c, ac = c - a;
  const Vec3 normal = cross(ab, cd);
  const double n = norm_squared(normal);
  const double s = dot(cross(ac, cd), normal), t = dot(cross(ac, ab), normal);
  if (!(s > 0 && s < n && t > 0 && t < n)) return {HUGE_VAL, 0, 0};
  // The vector is computed from points of the two segments, not along the normal, which is meaningless if they are
  // almost parallel.
  return (c + (t / n) * cd) - (a + (s / n) * ab);
}

}  // namespace

Vec3 nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double along = dot(p - a, ab), length = norm_squared(ab);
  if (!(along > 0)) return a;
  return along < length ? a + (along / length) * ab : b;
}

Vec3 nearest_on_triangle(const Vec3& p, const Corners3& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 normal = cross(b - a, c - a);
  const double n = norm_squared(normal);
  const auto is_inside = [&](const Vec3& from, const Vec3& to) { return dot(cross(normal, to - from), p - from) >= 0; };
  if (n > 0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a)) return p - (dot(p - a, normal) / n) * normal;
  // All three sides are tried, because in a needle it is not reliable to tell which of them p is beyond.
  Vec3 nearest = nearest_on_segment(p, a, b);
  double least = norm_squared(nearest - p);
  for (const Vec3& q : {nearest_on_segment(p, b, c), nearest_on_segment(p, c, a)}) {
    const double d = norm_squared(q - p);
    if (d < least) {
      least = d;
      nearest = q;
    }
  }
  return nearest;
}

Vec3 shortest_way(const Corners3& s, const Corners3& t) {
  Vec3 shortest{HUGE_VAL, 0, 0};
  const auto offer = [&](const Vec3& way) {
    if (norm_squared(way) < norm_squared(shortest)) shortest = way;
  };
  for (const Vec3& p : s) offer(nearest_on_triangle(p, t) - p);
  for (const Vec3& p : t) offer(p - nearest_on_triangle(p, s));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) offer(way_inside(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]));
  return shortest;
}

}  // namespace remesh
