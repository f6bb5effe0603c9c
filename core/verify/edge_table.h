/// The checker's own edges: who uses each edge, and in which direction.
#pragma once

#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"

namespace remesh::verification {

/// Faces as loops of corners, each in a patch.
struct Faces {
  std::span<const std::uint32_t> face_begin;
  std::span<const VertexId> corners;
  std::span<const PatchId> patch;

  std::size_t count() const { return patch.size(); }
  std::span<const VertexId> face(std::size_t f) const {
    return corners.subspan(face_begin[f], face_begin[f + 1] - face_begin[f]);
  }
};

/// One side of one face along an edge.
/// There is one for each corner of the input at once, so it is packed: patches are fewer than faces, and those fewer
/// than 2^31.
struct Use {
  Use() = default;
  Use(VertexId high_end, PatchId of, std::uint32_t from_corner, bool runs_forward)
      : high(high_end), half_edge(from_corner), patch_(of.value & 0x7fffffffu), is_forward_(runs_forward) {}

  VertexId high;                ///< the edge's larger vertex
  std::uint32_t half_edge = 0;  ///< the corner from which it runs
  PatchId patch() const { return PatchId(std::uint32_t{patch_}); }
  /// From the smaller vertex to the larger.
  bool is_forward() const { return is_forward_ != 0; }

  friend bool operator<(const Use& a, const Use& b) {
    return std::tuple(a.high, a.patch(), a.half_edge) < std::tuple(b.high, b.patch(), b.half_edge);
  }

 private:
  std::uint32_t patch_ : 31 = 0;
  std::uint32_t is_forward_ : 1 = 0;
};

/// An edge with its uses, ordered by patch, then half-edge.
struct Edge {
  VertexId low, high;
  std::span<const Use> uses;

  /// Inside a patch: exactly two faces, of one patch, that run along it in opposite directions. All else bounds.
  bool is_interior() const {
    return uses.size() == 2 && uses[0].patch() == uses[1].patch() && uses[0].is_forward() != uses[1].is_forward();
  }
  VertexId other(VertexId end) const { return end == low ? high : low; }
};

/// Do both edges have the same patches on the same sides? `is_flipped`: one is walked along, the other against.
bool have_same_uses(std::span<const Use> a, std::span<const Use> b, bool is_flipped);

/// Is one of the uses that patch's?
bool has_patch(std::span<const Use> uses, PatchId patch);

/// All edges of some faces, by their smaller vertex.
class EdgeTable {
 public:
  /// Cost:   O(n log n).
  EdgeTable(std::size_t vertex_count, const Faces& faces, RunControl& control);

  std::size_t vertex_count() const { return bucket_.size() - 1; }
  /// Calls visit(Edge) for each edge whose smaller vertex is in [begin, end), by (smaller, larger vertex).
  template <class Visit>
  void for_each_edge(std::size_t begin, std::size_t end, const Visit& visit) const {
    for (std::size_t v = begin; v < end; ++v)
      for (std::size_t i = bucket_[v]; i < bucket_[v + 1];) {
        std::size_t j = i + 1;
        while (j < bucket_[v + 1] && uses_[j].high == uses_[i].high) ++j;
        visit(Edge{VertexId(v), uses_[i].high, std::span(uses_).subspan(i, j - i)});
        i = j;
      }
  }
  /// The uses of the edge between a and b; empty if there is none.
  std::span<const Use> find(VertexId a, VertexId b) const;

 private:
  std::vector<std::uint32_t> bucket_;  ///< uses of vertex v's edges: [bucket_[v], bucket_[v + 1])
  std::vector<Use> uses_;
};

/// What the whole table tells.
struct EdgeCounts {
  std::uint64_t edges = 0;
  bool is_closed = true;      ///< every edge has two uses
  bool is_consistent = true;  ///< and these run in opposite directions
};

/// Counts the edges and lists those that bound patches, in order.
EdgeCounts list_boundary(const EdgeTable& table, RunControl& control, std::vector<Edge>& boundary);

}  // namespace remesh::verification
