#include "core/triangulation/constraint_recovery.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "core/geometry/exact/predicates.h"
#include "core/triangulation/delaunay_flips.h"

namespace remesh {
namespace {

/// Inserts segments one by one. The triangles that a segment crosses are removed and leave a cavity. The part to the
/// left of the segment and the part to its right are each filled by a scan. Flips then make the new triangles Delaunay.
class Recovery {
 public:
  Recovery(std::span<const Vec2> points, Triangulation2d& mesh, RunControl& control)
      : points_(points), mesh_(mesh), control_(control), in_cavity_(mesh.triangle_count(), 0) {
    mesh_.index_points(points.size());
  }

  /// Constrains the segment if it is an edge already. Returns whether it is.
  bool keep(std::uint32_t u, std::uint32_t v) {
    const Start start = leave(u, v);
    if (start.is_segment) mesh_.constrain(start.half_edge);
    return start.is_segment;
  }

  TriangulationOutcome insert(std::uint32_t u, std::uint32_t v) {
    const Start start = leave(u, v);
    if (start.half_edge == kNoHalfEdge) return TriangulationOutcome::kCrossingConstraints;
    if (start.is_segment) {
      mesh_.constrain(start.half_edge);
      return TriangulationOutcome::kDone;
    }
    if (!dig(start.half_edge, u, v)) return TriangulationOutcome::kCrossingConstraints;
    fill();
    delaunay_flips(points_, mesh_, changed_, control_);
    return TriangulationOutcome::kDone;
  }

 private:
  struct Start {
    std::uint32_t half_edge = kNoHalfEdge;
    /// True if `half_edge` is the segment itself, in either direction. Otherwise `half_edge` is the first one that it
    /// crosses.
    bool is_segment = false;
  };

  /// A side of the cavity, from u to v. Its edge i runs from vertex[i] to vertex[i+1]. Before the cavity
  /// was made, inner[i] was its half-edge inside the cavity.
  struct CavitySide {
    std::vector<std::uint32_t> vertex, inner;
  };

  int side(std::uint32_t u, std::uint32_t v, std::uint32_t p) const {
    return orient2d(points_[u], points_[v], points_[p]);
  }

  Start look(std::uint32_t h, std::uint32_t u, std::uint32_t v) const {
    if (mesh_.to(h) == v) return {h, true};
    if (mesh_.apex(h) == v) return {Triangulation2d::previous(h), true};
    if (side(u, v, mesh_.to(h)) < 0 && side(u, v, mesh_.apex(h)) > 0) return {Triangulation2d::next(h), false};
    return {};
  }

  /// Turns around u, from any of its triangles and in both directions, and finds the triangle through which the segment
  /// leaves u.
  Start leave(std::uint32_t u, std::uint32_t v) const {
    const std::uint32_t first = mesh_.edge_at(u);
    if (first == kNoHalfEdge) return {};
    for (std::uint32_t h = first; h != kNoHalfEdge;) {
      const Start found = look(h, u, v);
      if (found.half_edge != kNoHalfEdge) return found;
      h = mesh_.twin(Triangulation2d::previous(h));
      if (h == first) return {};
    }
    for (std::uint32_t g = mesh_.twin(first); g != kNoHalfEdge;) {
      const std::uint32_t h = Triangulation2d::next(g);
      const Start found = look(h, u, v);
      if (found.half_edge != kNoHalfEdge) return found;
      g = mesh_.twin(h);
    }
    return {};
  }

  /// Walks from the first crossed half-edge to v and collects the cavity. Returns false if a vertex or a constraint is
  /// in the way; the mesh is unchanged then.
  bool dig(std::uint32_t h, std::uint32_t u, std::uint32_t v) {
    cavity_.clear();
    left_ = {{u}, {}};
    right_ = {{u}, {}};
    // Half-edge h runs from the right of the segment to its left, seen from the triangle that was passed last.
    const auto pass_left = [&](std::uint32_t inner, std::uint32_t vertex) {
      left_.inner.push_back(inner);
      left_.vertex.push_back(vertex);
    };
    const auto pass_right = [&](std::uint32_t inner, std::uint32_t vertex) {
      right_.inner.push_back(inner);
      right_.vertex.push_back(vertex);
    };
    cavity_.push_back(h / 3);
    pass_left(Triangulation2d::next(h), mesh_.to(h));
    pass_right(Triangulation2d::previous(h), mesh_.from(h));
    while (true) {
      if (mesh_.is_constrained(h)) return false;
      const std::uint32_t g = mesh_.twin(h);  // runs from left to right
      const std::uint32_t apex = mesh_.apex(g);
      cavity_.push_back(g / 3);
      if (cavity_.size() % 4096 == 0) control_.check_and_move();
      const int s = apex == v ? 0 : side(u, v, apex);
      if (apex == v || s > 0) pass_left(Triangulation2d::previous(g), apex);
      if (apex == v || s < 0) pass_right(Triangulation2d::next(g), apex);
      if (apex == v) return true;
      if (s == 0) return false;
      h = s > 0 ? Triangulation2d::next(g) : Triangulation2d::previous(g);
    }
  }

  void fill() {
    for (const std::uint32_t t : cavity_) in_cavity_[t] = 1;
    // An edge with the cavity on both its sides hangs in the cavity. Such an edge occurs twice in the sides, once for
    // each side.
    outer_.clear();
    for (const CavitySide* cavity_side : {&left_, &right_})
      for (const std::uint32_t inner : cavity_side->inner) {
        const std::uint32_t outer = mesh_.twin(inner);
        outer_.push_back({outer, mesh_.is_constrained(inner), outer != kNoHalfEdge && in_cavity_[outer / 3] != 0});
      }
    slot_.assign(outer_.size(), kNoHalfEdge);
    slot_of_inner_.clear();
    for (std::size_t i = 0; i < left_.inner.size(); ++i) slot_of_inner_.push_back({left_.inner[i], i});
    for (std::size_t i = 0; i < right_.inner.size(); ++i)
      slot_of_inner_.push_back({right_.inner[i], left_.inner.size() + i});
    std::sort(slot_of_inner_.begin(), slot_of_inner_.end());

    next_free_ = 0;
    const std::uint32_t below = scan(left_, 0, false);
    const std::uint32_t above = scan(right_, left_.inner.size(), true);
    mesh_.join(below, above, true);

    for (std::size_t i = 0; i < slot_.size(); ++i) {
      if (!outer_[i].hangs) {
        mesh_.join(slot_[i], outer_[i].half_edge, outer_[i].constrained);
        continue;
      }
      const auto partner = std::lower_bound(slot_of_inner_.begin(), slot_of_inner_.end(),
                                            std::pair<std::uint32_t, std::size_t>{outer_[i].half_edge, 0});
      if (partner->second > i) mesh_.join(slot_[i], slot_[partner->second], outer_[i].constrained);
    }
    changed_.clear();
    for (const std::uint32_t t : cavity_) {
      in_cavity_[t] = 0;
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) changed_.push_back(h);
    }
  }

  /// This is the neighbour of a new triangle along one edge: either an edge of the cavity that waits for its slot, or
  /// an existing half-edge.
  struct Side {
    bool is_cavity_edge;
    std::uint32_t index;
  };

  void attach(Side side, std::uint32_t half_edge) {
    if (side.is_cavity_edge)
      slot_[side.index] = half_edge;
    else
      mesh_.join(side.index, half_edge);
  }

  /// Triangulates the area between a side of the cavity and the segment. Returns the half-edge along the segment. Every
  /// vertex of the side sees the segment, so it is enough to cut off each convex corner as it is met: at its end only
  /// the segment is left. (Toussaint and Avis, On a convex hull algorithm for polygons and its application to
  /// triangulation problems, 1982.)
  std::uint32_t scan(const CavitySide& cavity_side, std::size_t first_slot, bool is_right) {
    stack_.clear();
    stack_.push_back({cavity_side.vertex[0], {}});
    std::uint32_t base = kNoHalfEdge;
    for (std::size_t i = 1; i < cavity_side.vertex.size(); ++i) {
      const std::uint32_t p = cavity_side.vertex[i];
      Side to_p{true, static_cast<std::uint32_t>(first_slot + i - 1)};
      while (stack_.size() >= 2) {
        const std::uint32_t s1 = stack_.back().vertex, s2 = stack_[stack_.size() - 2].vertex;
        const int turn = orient2d(points_[s2], points_[s1], points_[p]);
        if (is_right ? turn <= 0 : turn >= 0) break;
        const std::uint32_t h = 3 * cavity_[next_free_++];
        if (is_right)
          mesh_.set_triangle(h, p, s2, s1);
        else
          mesh_.set_triangle(h, s2, p, s1);
        const std::uint32_t along_p = is_right ? Triangulation2d::previous(h) : Triangulation2d::next(h);
        const std::uint32_t along_s = is_right ? Triangulation2d::next(h) : Triangulation2d::previous(h);
        mesh_.index_triangle(h);
        attach(to_p, along_p);
        attach(stack_.back().side, along_s);
        stack_.pop_back();
        to_p = {false, h};
        base = h;
      }
      stack_.push_back({p, to_p});
    }
    return base;
  }

  struct Outer {
    std::uint32_t half_edge;
    bool constrained;
    bool hangs;
  };
  struct Entry {
    std::uint32_t vertex;
    Side side;  ///< beyond the edge from the entry below to this vertex
  };

  std::span<const Vec2> points_;
  Triangulation2d& mesh_;
  RunControl& control_;
  std::vector<std::uint8_t> in_cavity_;
  // This is the scratch memory of one insertion. It stays allocated for the next one.
  std::vector<std::uint32_t> cavity_, changed_, slot_;
  CavitySide left_, right_;
  std::vector<Outer> outer_;
  std::vector<std::pair<std::uint32_t, std::size_t>> slot_of_inner_;
  std::vector<Entry> stack_;
  std::size_t next_free_ = 0;
};

/// Returns 0 .. n-1 in rounds, each of which doubles what there is: it adds numbers that were chosen at random but are
/// always the same (Fisher and Yates, with the splitmix64 generator), in ascending order. The result of the recovery is
/// the same for any order, but the time is not: if the segments of a loop are inserted one after the other, each has to
/// cross the fan of triangles that the one before has left; and segments near each other are in memory together.
/// Source: Amenta, Choi, Rote, Incremental constructions con BRIO, 2003.
std::vector<std::uint32_t> in_rounds(std::size_t n) {
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  std::uint64_t state = 0;
  for (std::size_t i = n; i > 1; --i) {
    std::uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    std::swap(order[i - 1], order[(z ^ (z >> 31)) % i]);
  }
  for (auto begin = order.begin(), end = begin; begin != order.end(); begin = end) {
    end += std::min(order.end() - begin, std::max<std::ptrdiff_t>(begin - order.begin(), 1));
    std::sort(begin, end);
  }
  return order;
}

}  // namespace

TriangulationOutcome constraint_recovery(std::span<const Vec2> points, std::span<const Segment> segments,
                                         Triangulation2d& mesh, RunControl& control) {
  Recovery recovery(points, mesh, control);
  // A segment is looked for around the end where fewer segments meet. Around the other end it could be slow: at a hub
  // where many segments meet, every search would turn past all of them.
  std::vector<std::uint32_t> met(points.size(), 0);
  for (const auto& [u, v] : segments) {
    ++met[u];
    ++met[v];
  }
  // Most segments are edges already. The fastest order to find these is the order of the loops.
  std::vector<Segment> missing;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i % 256 == 0) control.check_and_move();
    auto [u, v] = segments[i];
    if (met[v] < met[u]) std::swap(u, v);
    if (!recovery.keep(u, v)) missing.push_back({u, v});
  }
  const std::vector<std::uint32_t> order = in_rounds(missing.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i % 256 == 0) control.check_and_move();
    const auto& [u, v] = missing[order[i]];
    const TriangulationOutcome outcome = recovery.insert(u, v);
    if (outcome != TriangulationOutcome::kDone) return outcome;
  }
  return TriangulationOutcome::kDone;
}

}  // namespace remesh
