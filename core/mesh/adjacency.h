/// Finds which faces share which edges. An edge may have one, two or more faces.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"

namespace remesh {

struct EdgeTag {
  static constexpr char kPrefix = 'e';
};
using EdgeId = Id<EdgeTag>;

/// The edges of a polygon mesh, found by grouping its half-edges. A half-edge runs from a corner of a face to that
/// face's next corner, and its number is the index of its first corner in `corners`.
class Adjacency {
 public:
  /// Output: the edges are ordered by (smaller vertex, larger vertex), and the half-edges of an edge are ascending.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n) for vertices of bounded degree, O(n log n) at worst; on the caller's TBB arena.
  Adjacency(std::size_t vertex_count, std::span<const std::uint32_t> face_begin, std::span<const VertexId> corners,
            RunControl& control);

  bool are_triangles() const { return are_triangles_; }
  std::size_t edge_count() const { return edge_begin_.size() - 1; }
  /// The half-edges of edge e, in either direction. There is one for each of its faces (two if a polygon meets itself
  /// there).
  std::span<const std::uint32_t> half_edges(EdgeId e) const {
    return std::span(half_edges_).subspan(edge_begin_[e.value], edge_begin_[e.value + 1] - edge_begin_[e.value]);
  }
  /// Moves out all half-edges, in the order of their edges. The adjacency is of no use afterwards.
  std::vector<std::uint32_t, DefaultInit<std::uint32_t>> take_order() && { return std::move(half_edges_); }
  /// The edges without twins, ascending. An edge has twins if it has exactly two half-edges, and these run in opposite
  /// directions. Most meshes have few edges without twins, and callers need only these.
  std::span<const EdgeId> odd_edges() const { return odd_edges_; }
  /// Finds the edge between two vertices. The result is invalid if there is none. Cost: O(log n).
  EdgeId find(VertexId a, VertexId b) const;
  /// Finds the edge of a half-edge. Cost: O(log n). It is not stored, because callers that look for a neighbour use the
  /// twin in most cases.
  EdgeId edge_of(std::uint32_t half_edge) const { return find(from(half_edge), to(half_edge)); }
  FaceId face_of(std::uint32_t half_edge) const { return are_triangles_ ? FaceId(half_edge / 3) : face_of_[half_edge]; }
  VertexId from(std::uint32_t half_edge) const { return corners_[half_edge]; }
  VertexId to(std::uint32_t half_edge) const { return corners_[next(half_edge)]; }
  /// The next corner of the same face.
  std::uint32_t next(std::uint32_t half_edge) const {
    if (are_triangles_) return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
    const std::uint32_t f = face_of_[half_edge].value;
    return half_edge + 1 == face_begin_[f + 1] ? face_begin_[f] : half_edge + 1;
  }
  /// The previous corner of the same face.
  std::uint32_t previous(std::uint32_t half_edge) const {
    const std::uint32_t f = face_of(half_edge).value;
    return half_edge == face_begin_[f] ? face_begin_[f + 1] - 1 : half_edge - 1;
  }
  /// The other half-edge of an edge that has exactly two, in opposite directions; otherwise kNone.
  std::uint32_t twin(std::uint32_t half_edge) const { return twin_[half_edge]; }

 private:
  VertexId smaller(std::uint32_t half_edge) const { return std::min(from(half_edge), to(half_edge)); }
  VertexId larger(std::uint32_t half_edge) const { return std::max(from(half_edge), to(half_edge)); }
  std::uint32_t sort_part(std::size_t first, std::size_t vertices, std::span<std::uint32_t> half_edges,
                          RunControl& control);
  void join_edge(std::span<const std::uint64_t> edge, std::uint32_t* half_edges);
  std::vector<EdgeId> number_edges(std::uint32_t edge, std::uint32_t begin, std::uint32_t end, RunControl& control);

  std::span<const std::uint32_t> face_begin_;
  std::span<const VertexId> corners_;
  using Numbers = std::vector<std::uint32_t, DefaultInit<std::uint32_t>>;
  Numbers half_edges_;
  Numbers edge_begin_;
  Numbers twin_;
  std::vector<EdgeId> odd_edges_;
  bool are_triangles_ = true;
  std::vector<FaceId> face_of_;  ///< empty if all faces are triangles
};

}  // namespace remesh
