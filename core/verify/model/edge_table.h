/// The checker's own edges: which faces use each edge, and in which direction.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"

namespace remesh::verification {

/// Faces as loops of corners, each in one patch.
struct Faces {
  std::span<const std::uint32_t> face_begin;
  std::span<const VertexId> corners;
  std::span<const PatchId> patch;
  /// For each patch, whether it is kept (see NumberedClaim::is_kept). Empty if no patch is.
  std::span<const std::uint8_t> is_kept = {};

  bool is_of_kept(std::size_t f) const { return !is_kept.empty() && is_kept[patch[f].value] != 0; }
  std::size_t count() const { return patch.size(); }
  std::span<const VertexId> face(std::size_t f) const {
    return corners.subspan(face_begin[f], face_begin[f + 1] - face_begin[f]);
  }
};

/// The use of an edge by one face.
struct Use {
  Use() = default;
  Use(VertexId high_end, PatchId of, std::uint32_t from_corner, bool runs_forward)
      : high(high_end), half_edge(from_corner), patch_(of.value & 0x7fffffffu), is_forward_(runs_forward) {}

  VertexId high;                ///< the edge's larger vertex
  std::uint32_t half_edge = 0;  ///< the corner at which the half-edge begins
  PatchId patch() const { return PatchId(std::uint32_t{patch_}); }
  /// True if it runs from the smaller vertex to the larger.
  bool is_forward() const { return is_forward_ != 0; }

  friend bool operator<(const Use& a, const Use& b) {
    if (a.high != b.high) return a.high < b.high;
    return std::tuple(a.patch(), a.half_edge) < std::tuple(b.patch(), b.half_edge);
  }

 private:
  /// 31 bits suffice, since there are fewer patches than faces, and fewer than 2^31 faces.
  std::uint32_t patch_ : 31 = 0;
  std::uint32_t is_forward_ : 1 = 0;
};

/// An edge with its uses, ordered by patch, then by half-edge.
struct Edge {
  VertexId low, high;
  std::span<const Use> uses;

  /// True if the edge is inside a patch: exactly two faces use it, both of one patch, in opposite directions. All
  /// other edges bound patches.
  bool is_interior() const {
    return uses.size() == 2 && uses[0].patch() == uses[1].patch() && uses[0].is_forward() != uses[1].is_forward();
  }
  VertexId other(VertexId end) const { return end == low ? high : low; }
};

/// True if both edges have the same patches on the same sides.
/// Input: `is_flipped` - one edge is walked along its direction, the other against it.
bool have_same_uses(std::span<const Use> a, std::span<const Use> b, bool is_flipped);

/// True if one of the uses belongs to that patch.
bool has_patch(std::span<const Use> uses, PatchId patch);

/// Totals over the edges of some faces.
struct EdgeCounts {
  std::uint64_t edges = 0;
  bool is_closed = true;      ///< every edge has two uses
  bool is_consistent = true;  ///< every edge has two uses, which run in opposite directions
};

/// The edges that bound patches, sorted by (smaller, larger vertex), together with the uses to which their spans
/// refer. Edges of which all uses belong to kept patches are left out.
struct BoundingEdges {
  BoundingEdges() = default;
  BoundingEdges(BoundingEdges&&) = default;
  BoundingEdges& operator=(BoundingEdges&&) = default;

  std::vector<Edge, DefaultInit<Edge>> edges;
  std::vector<Use, DefaultInit<Use>> uses;
};

/// All edges of some faces, sorted by their smaller vertex. Most edges are never needed again, and there are many of
/// them. So only the half-edge of each use is stored, and the rest is read from the faces.
class EdgeTable {
 public:
  /// Input:  `faces` - they must outlive the table; `order` - their half-edges sorted by (smaller, larger vertex,
  ///         half-edge) if the caller has them, which must outlive the table too. The order is tested; if it is wrong
  ///         or empty, the table sorts by itself.
  /// Cost:   O(n log n); O(n) with an order.
  EdgeTable(std::size_t vertex_count, const Faces& faces, std::span<const std::uint32_t> order, RunControl& control);
  EdgeTable(const EdgeTable&) = delete;
  EdgeTable& operator=(const EdgeTable&) = delete;

  std::size_t vertex_count() const { return bucket_.size() - 1; }
  const EdgeCounts& counts() const { return counts_; }
  /// Returns the bounding edges. It may be called once.
  BoundingEdges take_bounding() { return std::move(bounding_); }

  /// Calls visit(Edge) for each edge whose smaller vertex is in [begin, end), sorted by (smaller, larger vertex). The
  /// edge's uses are valid only during the call.
  /// Errors: kCancelled, kTimeout - stopped through the table's control.
  template <class Visit>
  void for_each_edge(std::size_t begin, std::size_t end, const Visit& visit) const {
    std::vector<Use> uses;
    StopCheck check(control_);
    for (std::size_t v = begin; v < end; ++v) {
      uses.clear();
      for (std::size_t i = bucket_[v]; i < bucket_[v + 1]; ++i) {
        check();
        uses.push_back(use(order_[i]));
      }
      if (is_order_given()) sort_stoppable(uses.begin(), uses.end(), control_);
      visit_edges(VertexId(v), uses, visit);
    }
  }
  /// Returns the uses of the edge between a and b; empty if there is no such edge.
  /// Cost: O(log n) for the edges at the smaller vertex, and the number of uses.
  std::vector<Use> find(VertexId a, VertexId b) const;
  /// Returns the number of uses of the edge between a and b.
  /// Cost: O(log n), however many uses there are.
  std::size_t count_uses(VertexId a, VertexId b) const { return half_edges_of(a, b).size(); }
  /// True if the edge between a and b exists and is inside a patch.
  /// Cost: O(log n), however many uses it has.
  bool is_interior(VertexId a, VertexId b) const {
    return count_uses(a, b) == 2 && Edge{std::min(a, b), std::max(a, b), find(a, b)}.is_interior();
  }

 private:
  struct Part;

  /// Input:  the uses of all edges with that smaller vertex, in order.
  template <class Visit>
  static void visit_edges(VertexId low, std::span<const Use> uses, const Visit& visit) {
    for (std::size_t i = 0; i < uses.size();) {
      std::size_t j = i + 1;
      while (j < uses.size() && uses[j].high == uses[i].high) ++j;
      visit(Edge{low, uses[i].high, uses.subspan(i, j - i)});
      i = j;
    }
  }

  std::size_t face_of(std::uint32_t half_edge) const { return face_of_.empty() ? half_edge / 3 : face_of_[half_edge]; }
  VertexId from(std::uint32_t half_edge) const { return faces_.corners[half_edge]; }
  VertexId to(std::uint32_t half_edge) const {
    if (face_of_.empty()) return faces_.corners[half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1];
    const std::size_t f = face_of_[half_edge];
    return faces_.corners[half_edge + 1 == faces_.face_begin[f + 1] ? faces_.face_begin[f] : half_edge + 1];
  }
  PatchId patch_of(std::uint32_t half_edge) const { return faces_.patch[face_of(half_edge)]; }
  /// True if the edge of two opposite half-edges is no bounding edge, or is left out of these.
  bool is_no_bound(std::uint32_t g, std::uint32_t h) const {
    const std::size_t of_g = face_of(g), of_h = face_of(h);
    return faces_.patch[of_g] == faces_.patch[of_h] || (faces_.is_of_kept(of_g) && faces_.is_of_kept(of_h));
  }
  Use use(std::uint32_t half_edge) const {
    const VertexId a = from(half_edge), b = to(half_edge);
    return {std::max(a, b), patch_of(half_edge), half_edge, a < b};
  }
  bool is_order_given() const { return half_edges_.empty(); }
  std::vector<Part> read_order(RunControl& control);
  std::optional<Part> read_part(std::size_t begin, std::size_t end);
  std::vector<Part> sort(RunControl& control);
  void add_parts(const std::vector<Part>& parts, RunControl& control);
  Part sort_part(std::size_t first, std::size_t last, std::uint32_t begin, std::span<std::uint32_t> half_edges);
  /// The half-edges of the edge between a and b.
  std::span<const std::uint32_t> half_edges_of(VertexId a, VertexId b) const;

  Faces faces_;
  const RunControl& control_;
  std::vector<std::uint32_t> face_of_;  ///< the face of each half-edge; empty if all faces are triangles
  using Numbers = std::vector<std::uint32_t, DefaultInit<std::uint32_t>>;
  Numbers bucket_;      ///< uses of vertex v's edges: [bucket_[v], bucket_[v + 1])
  Numbers half_edges_;  ///< sorted by patch and half-edge along each edge; empty if the order was given
  std::span<const std::uint32_t> order_;  ///< `half_edges_`, or the given order
  EdgeCounts counts_;
  BoundingEdges bounding_;
};

}  // namespace remesh::verification
