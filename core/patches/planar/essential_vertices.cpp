#include "core/patches/planar/essential_vertices.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// The max number of times, on average, that simplification looks at a vertex of a run. All vertices that remain after
/// that stay.
constexpr std::size_t kMaxLooks = 64;

/// The position of a point relative to a span: its distance from the span, and its place along it (0 at the start, 1
/// at the end).
struct SpanPosition {
  double distance, along;
};

SpanPosition about_span(const Vec3& a, const Vec3& b, const Vec3& p) {
  const Vec3 ab = b - a, ap = p - a;
  const double length_squared = norm_squared(ab);
  if (length_squared == 0) return {norm(ap), 0};
  const double along = dot(ap, ab) / length_squared;
  return {norm(cross(ab, ap)) / std::sqrt(length_squared), along};
}

/// The edges between patches, and the edges of this kind at each vertex.
class BoundaryEdges {
 public:
  BoundaryEdges(const Surface& surface, const Adjacency& adjacency, const BoundaryLoops& loops, RunControl& control)
      : adjacency_(adjacency), loops_(loops), degree_(surface.vertex_count(), 0) {
    StopCheck check(control);
    const std::size_t vertices = surface.vertex_count();
    const auto boundary = select_ids<EdgeId>(adjacency.edge_count(), kItemsPerBlock, control,
                                             [&](std::size_t e) { return is_boundary(EdgeId(e)); });
    for (const EdgeId e : boundary) {
      check();
      ++degree_[low(e).value];
      ++degree_[high(e).value];
    }
    vertices_ = select_ids<VertexId>(vertices, kItemsPerBlock, control, [&](std::size_t v) { return degree_[v] > 0; });
    // Most vertices have no boundary edges, and for them nothing is written.
    first_.resize(vertices);
    std::uint32_t all = 0;
    for (const VertexId v : vertices_) {
      check();
      first_[v.value] = all;
      all += std::exchange(degree_[v.value], 0);
    }
    incident_.resize(all);
    for (const EdgeId e : boundary)
      for (const VertexId v : {low(e), high(e)}) {
        check();
        incident_[first_[v.value] + degree_[v.value]++] = e;
      }
  }

  /// The vertices of the boundary, ascending.
  const std::vector<VertexId>& vertices() const { return vertices_; }

  VertexId other_end(EdgeId e, VertexId v) const { return low(e) == v ? high(e) : low(e); }

  /// The boundary edges at a vertex.
  std::span<const EdgeId> edges_at(VertexId v) const {
    return std::span(incident_).subspan(first_[v.value], degree_[v.value]);
  }
  bool has_edge(VertexId a, VertexId b) const {
    const EdgeId e = adjacency_.find(a, b);
    return e.is_valid() && is_boundary(e);
  }
  /// The other one of the two boundary edges at a vertex.
  EdgeId other_edge(VertexId v, EdgeId e) const {
    const auto edges = edges_at(v);
    return edges[0] == e ? edges[1] : edges[0];
  }

 private:
  VertexId low(EdgeId e) const {
    const std::uint32_t h = adjacency_.half_edges(e)[0];
    return std::min(adjacency_.from(h), adjacency_.to(h));
  }
  VertexId high(EdgeId e) const {
    const std::uint32_t h = adjacency_.half_edges(e)[0];
    return std::max(adjacency_.from(h), adjacency_.to(h));
  }

  bool is_boundary(EdgeId e) const { return loops_.is_boundary[adjacency_.half_edges(e)[0]]; }

  const Adjacency& adjacency_;
  const BoundaryLoops& loops_;
  std::vector<VertexId> vertices_;
  std::vector<std::uint32_t> degree_;                             ///< boundary edges at each vertex
  std::vector<std::uint32_t, DefaultInit<std::uint32_t>> first_;  ///< where each vertex's edges begin in `incident_`
  std::vector<EdgeId> incident_;
};

/// Chooses the vertices that stay, run by run: a run is the boundary between two vertices that are known to stay.
class Selection {
 public:
  Selection(const Surface& surface, const Adjacency& adjacency, const BoundaryLoops& loops,
            const IdVector<VertexId, std::uint8_t>& forced, std::span<const VertexId> pinched, double tolerance,
            RunControl& control)
      : surface_(surface),
        forced_(forced),
        pinched_(pinched),
        tolerance_(tolerance),
        control_(control),
        check_(control),
        boundary_(surface, adjacency, loops, control),
        is_walked_(adjacency.edge_count(), false) {}

  EssentialVertices run() {
    mark_junctions();
    // Parts that touch in a vertex must still touch in it afterwards.
    for (const VertexId v : pinched_) essential_[v] = 1;
    for (const VertexId v : boundary_.vertices()) {
      check_();
      if (!essential_[v]) continue;
      // Most runs of scans are single edges.
      for (const EdgeId e : boundary_.edges_at(v))
        if (!essential_[boundary_.other_end(e, v)]) walk(v, e);
    }
    for (const VertexId v : boundary_.vertices()) {
      check_();
      if (!essential_[v] && !is_walked_[boundary_.edges_at(v)[0].value]) close_ring(v);
    }
    keep_doubled_spans();
    // A vertex inside a patch has a closed fan of that patch's faces. If it is a corner of some other face, too, its
    // faces are not all connected there, so it is pinched.
    return {std::move(essential_), pinched_.empty()};
  }

 private:
  const Vec3& at(VertexId v) const { return surface_.local[v]; }

  void mark_junctions() {
    essential_.assign(surface_.vertex_count(), 0);
    for_blocks(boundary_.vertices().size(), kItemsPerBlock, control_, [&](std::size_t i, std::size_t end) {
      for (; i < end; ++i) {
        const VertexId v = boundary_.vertices()[i];
        const auto edges = boundary_.edges_at(v);
        bool stays = forced_[v] != 0 || edges.size() != 2;
        if (!stays) {
          const VertexId a = boundary_.other_end(edges[0], v), b = boundary_.other_end(edges[1], v);
          const SpanPosition position = about_span(at(a), at(b), at(v));
          stays = position.distance > tolerance_ || position.along <= 0 || position.along >= 1;
        }
        essential_[v] = stays;
      }
    });
  }

  /// Follows the boundary from an essential vertex to the next one, and simplifies the run between them.
  void walk(VertexId start, EdgeId e) {
    if (is_walked_[e.value]) return;
    run_.assign(1, start);
    VertexId v = start;
    while (true) {
      check_();
      is_walked_[e.value] = true;
      v = boundary_.other_end(e, v);
      run_.push_back(v);
      if (essential_[v]) break;
      e = boundary_.other_edge(v, e);
    }
    simplify(0, run_.size() - 1);
  }

  /// Simplifies a closed boundary without a corner. Its anchors are its smallest vertex and the vertex farthest from
  /// there.
  void close_ring(VertexId start) {
    run_.assign(1, start);
    EdgeId e = boundary_.edges_at(start)[0];
    for (VertexId v = boundary_.other_end(e, start); v != start; v = boundary_.other_end(e, v)) {
      check_();
      is_walked_[e.value] = true;
      run_.push_back(v);
      e = boundary_.other_edge(v, e);
    }
    is_walked_[e.value] = true;
    const auto smaller = [&](VertexId a, VertexId b) { return at(a) != at(b) ? at(a) < at(b) : a < b; };
    std::rotate(run_.begin(), std::min_element(run_.begin(), run_.end(), smaller), run_.end());
    const Vec3 anchor = at(run_[0]);
    const auto nearer = [&](VertexId a, VertexId b) {
      const double da = norm_squared(at(a) - anchor), db = norm_squared(at(b) - anchor);
      return da != db ? da < db : smaller(b, a);
    };
    const auto farthest = static_cast<std::size_t>(std::max_element(run_.begin(), run_.end(), nearer) - run_.begin());
    run_.push_back(run_[0]);
    essential_[run_[0]] = 1;
    essential_[run_[farthest]] = 1;
    simplify(0, farthest);
    simplify(farthest, run_.size() - 1);
    const auto essential = std::count_if(run_.begin(), run_.end() - 1, [&](VertexId v) { return essential_[v] != 0; });
    if (essential < 3)
      for (const VertexId v : run_) essential_[v] = 1;
  }

  /// Makes vertices of a run essential, between two essential vertices, where the tolerance requires this. The vertex
  /// farthest from the span becomes essential, and then both sides of it are treated in the same way (Douglas and
  /// Peucker, 1973). Among equally far vertices, the one at the smallest place counts.
  void simplify(std::size_t begin, std::size_t end) {
    std::size_t looks = 0;
    spans_.assign(1, {begin, end});
    while (!spans_.empty()) {
      const auto [i, j] = spans_.back();
      spans_.pop_back();
      if (j - i < 2) continue;
      looks += j - i;
      const Vec3 a = at(run_[i]), b = at(run_[j]);
      double farthest = tolerance_, reached = 0;
      std::size_t split = 0;
      bool is_in_order = true;
      for (std::size_t k = i + 1; k < j; ++k) {
        check_();
        const SpanPosition position = about_span(a, b, at(run_[k]));
        if (position.distance > farthest ||
            (split != 0 && position.distance == farthest && at(run_[k]) < at(run_[split]))) {
          farthest = position.distance;
          split = k;
        }
        is_in_order = is_in_order && position.along > reached && position.along < 1;
        reached = position.along;
      }
      if (split == 0 && is_in_order) continue;
      if (split == 0 || looks > kMaxLooks * (end - begin + 1)) {  // it folds back, or is too costly: all stay
        for (std::size_t k = i + 1; k < j; ++k) essential_[run_[k]] = 1;
        continue;
      }
      essential_[run_[split]] = 1;
      spans_.push_back({i, split});
      spans_.push_back({split, j});
    }
  }

  /// Finds two boundaries between the same two vertices that are both straight within the tolerance. They would become
  /// one edge, so that a crack would close or a thin patch vanish. Therefore all vertices of such runs stay. One of the
  /// two may be an edge, which has no vertices to keep.
  void keep_doubled_spans() {
    struct ReplacedSpan {
      VertexId a, b;      // a < b; the run begins at a
      EdgeId first_edge;  // the first edge of the run
    };
    std::vector<ReplacedSpan> spans;
    for (const VertexId v : boundary_.vertices()) {
      check_();
      if (!essential_[v]) continue;
      for (const EdgeId first : boundary_.edges_at(v)) {
        EdgeId e = first;
        VertexId w = boundary_.other_end(e, v);
        if (essential_[w]) continue;
        while (!essential_[w]) {
          check_();
          e = boundary_.other_edge(w, e);
          w = boundary_.other_end(e, w);
        }
        if (v < w) spans.push_back({v, w, first});
      }
    }
    const auto key = [](const ReplacedSpan& c) { return std::pair{c.a, c.b}; };
    sort_stoppable(spans.begin(), spans.end(), control_, [&](const ReplacedSpan& c, const ReplacedSpan& d) {
      return key(c) != key(d) ? key(c) < key(d) : c.first_edge < d.first_edge;
    });
    for (std::size_t i = 0; i < spans.size(); ++i) {
      check_();
      const bool is_doubled = (i > 0 && key(spans[i]) == key(spans[i - 1])) ||
                              (i + 1 < spans.size() && key(spans[i]) == key(spans[i + 1])) ||
                              boundary_.has_edge(spans[i].a, spans[i].b);
      if (!is_doubled) continue;
      EdgeId e = spans[i].first_edge;
      for (VertexId w = boundary_.other_end(e, spans[i].a); w != spans[i].b; w = boundary_.other_end(e, w)) {
        check_();
        essential_[w] = 1;
        e = boundary_.other_edge(w, e);
      }
    }
  }

  const Surface& surface_;
  const IdVector<VertexId, std::uint8_t>& forced_;
  std::span<const VertexId> pinched_;
  double tolerance_;
  RunControl& control_;
  StopCheck check_;
  const BoundaryEdges boundary_;
  IdVector<VertexId, std::uint8_t> essential_;
  std::vector<bool> is_walked_;  ///< by edge
  std::vector<VertexId> run_;
  std::vector<std::pair<std::size_t, std::size_t>> spans_;
};

}  // namespace

EssentialVertices essential_vertices(const Surface& surface, const Adjacency& adjacency, const BoundaryLoops& loops,
                                     const IdVector<VertexId, std::uint8_t>& forced, std::span<const VertexId> pinched,
                                     double tolerance, RunControl& control) {
  return Selection(surface, adjacency, loops, forced, pinched, tolerance, control).run();
}

}  // namespace remesh
