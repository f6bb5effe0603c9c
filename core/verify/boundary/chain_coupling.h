/// Walks along two polylines at once, and bounds their distance on the way.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "core/base/stoppable.h"
#include "core/base/vec.h"

namespace remesh::verification {

/// Returns where a point is opposite the line from a to b: 0 at a, 1 at b. Parts of vectors along `normal` do not
/// count.
/// Input: `normal` - a unit vector, or null.
inline double place_along(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& normal) {
  const auto across = [&](const Vec3& v) { return v - dot(v, normal) * normal; };
  const Vec3 way = across(b - a);
  const double square = norm_squared(way);
  return square > 0 ? dot(across(p - a), way) / square : 1;
}

/// Moves one point along each of two polylines, from their beginnings to their ends, never backwards. It stops
/// wherever one of the points is at a vertex. Between two stops both points move linearly, so their difference is
/// linear, too, and its length is largest at a stop.
/// Input:  x, y - polylines of at least two vertices; normal_at(p) - a unit vector, or null. The point that is wanted
///         on the other polyline is the nearest one, if distances along this vector do not count.
/// Output: visit(x before, y before, x after, y after) is called for each step. The steps depend on rounding, but
///         whatever the steps are, the largest difference is a bound on the distance of the polylines.
/// Cost:   O(vertices).
template <class NormalAt, class Visit>
void couple(std::span<const Vec3> x, std::span<const Vec3> y, const NormalAt& normal_at, const Visit& visit,
            StopCheck& check) {
  struct Walker {
    std::span<const Vec3> line;
    std::size_t edge = 0;
    double place = 0;  ///< on the edge, from 0 to 1
    Vec3 at;

    bool is_at_end() const { return edge + 1 == line.size(); }
    const Vec3& next() const { return line[edge + 1]; }
    /// The place where the point is opposite p, but not before its present place.
    double opposite(const Vec3& p, const Vec3& normal) const {
      return std::max(place, place_along(p, line[edge], next(), normal));
    }
    Vec3 point(double t) const { return t >= 1 ? next() : line[edge] + t * (next() - line[edge]); }
    void go_to(double t) {
      at = point(t);
      place = t;
      if (t < 1) return;
      ++edge;
      place = 0;
    }
  };
  Walker a{x, 0, 0, x[0]}, b{y, 0, 0, y[0]};
  while (!a.is_at_end() || !b.is_at_end()) {
    check();
    const Vec3 from_a = a.at, from_b = b.at;
    if (b.is_at_end()) {
      a.go_to(1);
    } else if (a.is_at_end()) {
      b.go_to(1);
    } else {
      const double on_b = b.opposite(a.next(), normal_at(a.next())), on_a = a.opposite(b.next(), normal_at(b.next()));
      const bool may_a_go = on_b < 1, may_b_go = on_a < 1;
      const bool is_a_nearer = norm_squared(a.next() - b.point(on_b)) <= norm_squared(b.next() - a.point(on_a));
      if (may_a_go && (!may_b_go || is_a_nearer)) {
        b.go_to(on_b);
        a.go_to(1);
      } else if (may_b_go) {
        a.go_to(on_a);
        b.go_to(1);
      } else {
        a.go_to(1);
        b.go_to(1);
      }
    }
    visit(from_a, from_b, a.at, b.at);
  }
}

}  // namespace remesh::verification
