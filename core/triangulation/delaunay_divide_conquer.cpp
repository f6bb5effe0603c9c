#include "core/triangulation/delaunay_divide_conquer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/base/ids.h"
#include "core/base/parallel.h"
#include "core/geometry/exact/predicates.h"

namespace remesh {
namespace {

/// Half-edges 2i and 2i+1 are the two directions of edge i. `next` is the next half-edge counter-clockwise around the
/// origin.
struct HalfEdge {
  std::uint32_t origin;  // kNone while the slot is free
  std::uint32_t next;    // in a free slot, the next free slot
  std::uint32_t previous;
};

constexpr std::uint32_t sym(std::uint32_t h) { return h ^ 1; }

/// The triangulation of a run of points. The first and last point are those in the order of the cut.
struct Part {
  std::uint32_t first;  // the hull half-edge, counter-clockwise, that leaves the first point
  std::uint32_t last;   // the hull half-edge, clockwise, that leaves the last point
  // Slots for new edges, as a list linked by `next`. A part owns three slots per point, so parts that are computed in
  // parallel never share slots.
  std::uint32_t free_head;
  std::uint32_t free_tail;
};

/// Divides the points by vertical cuts into strips of about sqrt(n) points, and the strips by horizontal cuts into runs
/// of 2 or 3 points. Cutting strips across makes the small parts compact, so that few of the edges made early are
/// deleted later.
/// A horizontal cut is a vertical one in a frame turned by a right angle, which changes no orientation and no circle.
/// So merging is the same, and only the order of points, (y, -x), differs.
class DivideAndConquer {
 public:
  DivideAndConquer(std::span<const Vec2> input, RunControl& control)
      : input_(input), control_(control), order_(input.size()), points_(input.size()), edges_(6 * input.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    strip_size_ = static_cast<std::size_t>(kStripFactor * std::sqrt(static_cast<double>(input.size()))) + 3;
  }

  Triangulation2d run() {
    const Part whole = triangulate(0, input_.size());
    return extract(whole.last);
  }

 private:
  static constexpr double kStripFactor = 2;              // see experiments.md, Divide and conquer
  static constexpr std::size_t kParallelSize = 1 << 15;  // smaller parts are not worth a task
  static constexpr std::uint32_t kCheckInterval = 4096;

  // --- dividing ---

  Part triangulate(std::size_t begin, std::size_t end) {
    control_.check();
    if (end - begin <= strip_size_) return triangulate_strip(begin, end);
    const std::size_t middle = begin + (end - begin) / 2;
    Part left, right;
    const auto do_left = [&] { left = triangulate(begin, middle); };
    const auto do_right = [&] { right = triangulate(middle, end); };
    if (end - begin >= kParallelSize) {
      do_all(end - begin, do_left, do_right);
    } else {
      do_left();
      do_right();
    }
    return merge(left, right);
  }

  Part triangulate_strip(std::size_t begin, std::size_t end) {
    std::sort(order_.begin() + begin, order_.begin() + end, [&](std::uint32_t i, std::uint32_t j) {
      const Vec2 a = input_[i], b = input_[j];
      return a.y != b.y ? a.y < b.y : a.x > b.x;
    });
    for (std::size_t i = begin; i < end; ++i) points_[i] = input_[order_[i]];
    return turned(triangulate_run(begin, end));
  }

  Part triangulate_run(std::size_t begin, std::size_t end) {
    const std::size_t size = end - begin;
    if (size <= 3) return triangulate_leaf(static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(size));
    const std::size_t middle = begin + size / 2;
    const Part left = triangulate_run(begin, middle);
    const Part right = triangulate_run(middle, end);
    return merge(left, right);
  }

  Part triangulate_leaf(std::uint32_t begin, std::uint32_t size) {
    Part part;
    part.free_head = 6 * begin;
    part.free_tail = 6 * (begin + size) - 2;
    for (std::uint32_t h = part.free_head; h <= part.free_tail; h += 2) edges_[h] = {kNone, h + 2, kNoHalfEdge};
    edges_[part.free_tail].next = kNoHalfEdge;

    const std::uint32_t a = make_edge(part, begin, begin + 1);
    part.first = a;
    part.last = sym(a);
    if (size == 2) return part;
    const std::uint32_t b = make_edge(part, begin + 1, begin + 2);
    insert_after(sym(a), b);
    part.last = sym(b);
    const int turn = orient2d(points_[begin], points_[begin + 1], points_[begin + 2]);
    if (turn == 0) return part;
    const std::uint32_t c = connect(part, b, a);
    if (turn < 0) {
      part.first = sym(c);
      part.last = c;
    }
    return part;
  }

  /// Finds the first and last point of a part in the order of (x, y). Walks along the hull clockwise, with the outside
  /// to the left.
  Part turned(Part part) const {
    const std::uint32_t start = part.last;
    std::uint32_t h = start;
    do {
      if (origin_point(part.last) < origin_point(h)) part.last = h;
      if (target_point(h) < origin_point(part.first)) part.first = sym(h);
      h = left_next(h);
    } while (h != start);
    // Both `first` and `last` began as hull edges of the old frame, so their directions along the hull are right.
    return part;
  }

  // --- merging ---

  /// Joins two parts. All points of `left` must be before those of `right` in the order of the cut.
  Part merge(const Part& left, const Part& right) {
    Part part{left.first, right.last, left.free_head, right.free_tail};
    edges_[left.free_tail].next = right.free_head;

    std::uint32_t base = lower_tangent(part, left.last, right.first);
    for (std::uint32_t step = 1;; ++step) {
      if (step % kCheckInterval == 0) control_.check_and_move();
      // The base runs from right to left. The next triangle stands on it, and its apex is a neighbour of one of the
      // base's ends.
      const std::uint32_t left_point = origin(sym(base)), right_point = origin(base);
      const Vec2 l = points_[left_point], r = points_[right_point];

      std::uint32_t left_candidate = edges_[sym(base)].next;
      Vec2 left_apex = target_point(left_candidate);
      const bool left_is_valid = orient2d(left_apex, l, r) > 0;
      if (left_is_valid) {
        for (;;) {
          const std::uint32_t following = edges_[left_candidate].next;
          if (following == sym(base)) break;
          const Vec2 next_apex = target_point(following);
          if (in_circle_perturbed(l, r, left_apex, next_apex) <= 0) break;
          remove(part, left_candidate);
          left_candidate = following;
          left_apex = next_apex;
        }
      }
      std::uint32_t right_candidate = edges_[base].previous;
      Vec2 right_apex = target_point(right_candidate);
      const bool right_is_valid = orient2d(right_apex, l, r) > 0;
      if (right_is_valid) {
        for (;;) {
          const std::uint32_t following = edges_[right_candidate].previous;
          if (following == base) break;
          const Vec2 next_apex = target_point(following);
          if (in_circle_perturbed(l, r, right_apex, next_apex) <= 0) break;
          remove(part, right_candidate);
          right_candidate = following;
          right_apex = next_apex;
        }
      }

      if (!left_is_valid && !right_is_valid) return part;
      if (!left_is_valid || (right_is_valid && in_circle_perturbed(left_apex, l, r, right_apex) > 0))
        base = connect(part, right_candidate, sym(base));
      else
        base = connect(part, sym(base), sym(left_candidate));
    }
  }

  /// Adds the edge, from right to left, below which neither part has a point. Updates part.first and part.last so that
  /// they stay on the hull.
  std::uint32_t lower_tangent(Part& part, std::uint32_t left_inner, std::uint32_t right_inner) {
    for (;;) {
      if (orient2d(origin_point(right_inner), origin_point(left_inner), target_point(left_inner)) > 0)
        left_inner = left_next(left_inner);
      else if (orient2d(origin_point(left_inner), target_point(right_inner), origin_point(right_inner)) > 0)
        right_inner = edges_[sym(right_inner)].next;
      else
        break;
    }
    const std::uint32_t base = connect(part, sym(right_inner), left_inner);
    if (origin(left_inner) == origin(part.first)) part.first = sym(base);
    if (origin(right_inner) == origin(part.last)) part.last = base;
    return base;
  }

  // --- edges ---

  std::uint32_t origin(std::uint32_t h) const { return edges_[h].origin; }
  Vec2 origin_point(std::uint32_t h) const { return points_[edges_[h].origin]; }
  Vec2 target_point(std::uint32_t h) const { return points_[edges_[sym(h)].origin]; }
  /// The half-edge that follows h around the face to its left.
  std::uint32_t left_next(std::uint32_t h) const { return edges_[sym(h)].previous; }

  std::uint32_t make_edge(Part& part, std::uint32_t from, std::uint32_t to) {
    const std::uint32_t h = part.free_head;
    assert(h != part.free_tail);  // a plane graph has fewer than 3n edges
    part.free_head = edges_[h].next;
    edges_[h] = {from, h, h};
    edges_[sym(h)] = {to, sym(h), sym(h)};
    return h;
  }

  /// Inserts h counter-clockwise after `place`. Before, h is alone at its origin.
  void insert_after(std::uint32_t place, std::uint32_t h) {
    const std::uint32_t following = edges_[place].next;
    edges_[h].next = following;
    edges_[h].previous = place;
    edges_[place].next = h;
    edges_[following].previous = h;
  }

  /// Adds an edge from the target of a to the origin of b, across the face to the left of both.
  std::uint32_t connect(Part& part, std::uint32_t a, std::uint32_t b) {
    const std::uint32_t h = make_edge(part, origin(sym(a)), origin(b));
    insert_after(left_next(a), h);
    insert_after(b, sym(h));
    return h;
  }

  void remove(Part& part, std::uint32_t h) {
    for (const std::uint32_t side : {h, sym(h)}) {
      edges_[edges_[side].previous].next = edges_[side].next;
      edges_[edges_[side].next].previous = edges_[side].previous;
    }
    const std::uint32_t slot = h & ~1u;
    edges_[slot] = {kNone, part.free_head, kNoHalfEdge};
    part.free_head = slot;
  }

  // --- the answer ---

  /// Makes triangles of the edges, in an order that depends on the triangulation alone. `hull` has the outside to its
  /// left.
  Triangulation2d extract(std::uint32_t hull) {
    const std::uint32_t n = static_cast<std::uint32_t>(input_.size());
    std::vector<std::uint32_t> edge_at(n);
    for (std::uint32_t h = 0; h < edges_.size(); ++h) {
      if (edges_[h & ~1u].origin == kNone) continue;
      edges_[h].origin = order_[edges_[h].origin];
      edge_at[edges_[h].origin] = h;
    }
    std::uint32_t hull_size = 0;
    constexpr std::uint32_t kOutside = kNoHalfEdge - 1;
    std::vector<std::uint32_t> slot(edges_.size(), kNoHalfEdge);  // the place of a half-edge in the result
    std::uint32_t h = hull;
    do {
      slot[h] = kOutside;
      ++hull_size;
      h = left_next(h);
    } while (h != hull);

    Triangulation2d result;
    if (hull_size == 2 * (n - 1)) return result;  // the edges are a path: all points are on one line
    result.reserve(2 * n - 2 - hull_size);
    const auto begins_triangle = [&](std::uint32_t g) {
      return slot[g] != kOutside && origin(sym(g)) > origin(g) && origin(sym(edges_[g].next)) > origin(g);
    };
    for (std::uint32_t p = 0; p < n; ++p) {
      if (p % kCheckInterval == 0) control_.check_and_move();
      // The neighbours that are after p in order lie in a half-plane, so the triangles to be made at p are one run
      // around it.
      std::uint32_t g = edge_at[p];
      do {
        if (begins_triangle(g) && !begins_triangle(edges_[g].previous)) break;
        g = edges_[g].next;
      } while (g != edge_at[p]);
      for (; begins_triangle(g); g = edges_[g].next) {
        const std::uint32_t second = left_next(g), third = left_next(second);
        const std::uint32_t first_slot = result.add_triangle(p, origin(second), origin(third));
        slot[g] = first_slot;
        slot[second] = first_slot + 1;
        slot[third] = first_slot + 2;
        for (const std::uint32_t side : {g, second, third})
          if (slot[sym(side)] < kOutside) result.join(slot[side], slot[sym(side)]);
      }
    }
    return result;
  }

  std::span<const Vec2> input_;
  RunControl& control_;
  std::size_t strip_size_;
  std::vector<std::uint32_t> order_;  // input indices, strip by strip and upwards in each
  std::vector<Vec2> points_;          // in the order of `order_`
  std::vector<HalfEdge> edges_;
};

}  // namespace

Triangulation2d delaunay_divide_conquer(std::span<const Vec2> points, RunControl& control) {
  assert(std::is_sorted(points.begin(), points.end()));
  if (points.size() < 3) return {};
  return DivideAndConquer(points, control).run();
}

}  // namespace remesh
