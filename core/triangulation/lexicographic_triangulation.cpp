#include "core/triangulation/lexicographic_triangulation.h"

#include <cstdint>
#include <vector>

#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

/// The hull of the sweep is a counter-clockwise ring of points. `edge[p]` is the half-edge from p to next[p].
class Sweep {
 public:
  explicit Sweep(std::span<const Vec2> points)
      : points_(points), next_(points.size()), previous_(points.size()), edge_(points.size(), kNoHalfEdge) {
    mesh_.reserve(2 * points.size());
  }

  Triangulation2d run(RunControl& control) {
    const std::uint32_t n = static_cast<std::uint32_t>(points_.size());
    // This is the first point that does not lie on the line through the points before it.
    std::uint32_t first = 2;
    while (first < n && orient2d(points_[0], points_[1], points_[first]) == 0) ++first;
    if (n < 3 || first == n) return {};
    start(first);
    for (std::uint32_t p = first + 1; p < n; ++p) {
      if (p % 4096 == 0) control.check_and_move();
      attach(p);
    }
    return std::move(mesh_);
  }

 private:
  /// Joins point `first` to the collinear points 0 .. first-1 by a fan of triangles.
  void start(std::uint32_t first) {
    const bool left = orient2d(points_[0], points_[1], points_[first]) > 0;
    // This is the half-edge of the triangle before that is shared with the next one.
    std::uint32_t previous_side = kNoHalfEdge;
    for (std::uint32_t p = 0; p + 1 < first; ++p) {
      const std::uint32_t a = left ? p : p + 1, b = left ? p + 1 : p;
      const std::uint32_t h = mesh_.add_triangle(a, b, first);
      edge_[a] = h;
      link(a, b);
      const std::uint32_t near = left ? Triangulation2d::previous(h) : Triangulation2d::next(h);
      const std::uint32_t far = left ? Triangulation2d::next(h) : Triangulation2d::previous(h);
      if (previous_side == kNoHalfEdge)
        edge_[left ? first : p] = near;
      else
        mesh_.join(previous_side, near);
      previous_side = far;
    }
    const std::uint32_t last = first - 1;
    edge_[left ? last : first] = previous_side;
    if (left) {
      link(last, first);
      link(first, 0);
    } else {
      link(0, first);
      link(first, last);
    }
  }

  /// Joins p to every hull edge that it sees. In lexicographic order p comes after all points before, so these edges
  /// form a run around p-1.
  void attach(std::uint32_t p) {
    // Point p-1 is on the hull, because it comes last of all points so far.
    std::uint32_t upper = p - 1;
    // This is the half-edge of the newest triangle on the upper side. It waits for its neighbour.
    std::uint32_t waiting = kNoHalfEdge;
    std::uint32_t lower_waiting = kNoHalfEdge;
    while (sees(p, upper, next_[upper])) {
      const std::uint32_t following = next_[upper];
      const std::uint32_t h = add_outside(p, upper);
      if (waiting == kNoHalfEdge)
        lower_waiting = Triangulation2d::next(h);
      else
        mesh_.join(waiting, Triangulation2d::next(h));
      waiting = Triangulation2d::previous(h);
      upper = following;
    }
    std::uint32_t lower = p - 1;
    while (sees(p, previous_[lower], lower)) {
      const std::uint32_t preceding = previous_[lower];
      const std::uint32_t h = add_outside(p, preceding);
      if (lower_waiting == kNoHalfEdge)
        waiting = Triangulation2d::previous(h);
      else
        mesh_.join(lower_waiting, Triangulation2d::previous(h));
      lower_waiting = Triangulation2d::next(h);
      lower = preceding;
    }
    link(lower, p);
    link(p, upper);
    edge_[lower] = lower_waiting;
    edge_[p] = waiting;
  }

  bool sees(std::uint32_t p, std::uint32_t a, std::uint32_t b) const {
    return orient2d(points_[a], points_[b], points_[p]) < 0;
  }

  /// Adds the triangle outside hull edge (a, next a), with apex p. Its first half-edge is the twin of the hull edge.
  /// The next one runs from a to p, and the last one from p to next a.
  std::uint32_t add_outside(std::uint32_t p, std::uint32_t a) {
    const std::uint32_t h = mesh_.add_triangle(next_[a], a, p);
    mesh_.join(h, edge_[a]);
    return h;
  }

  void link(std::uint32_t a, std::uint32_t b) {
    next_[a] = b;
    previous_[b] = a;
  }

  std::span<const Vec2> points_;
  std::vector<std::uint32_t> next_, previous_, edge_;
  Triangulation2d mesh_;
};

}  // namespace

Triangulation2d lexicographic_triangulation(std::span<const Vec2> points, RunControl& control) {
  return Sweep(points).run(control);
}

}  // namespace remesh
