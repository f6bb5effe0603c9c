/// The graph of the edges that bound patches, and its chains. A chain is a run of edges through vertices that are
/// inside a seam.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/stoppable.h"
#include "core/verify/model/edge_table.h"

namespace remesh::verification {

/// A run of edges between two vertices at which the graph is cut.
struct Chain {
  VertexId low, high;       ///< the ends of the chain
  std::uint32_t edge = 0;   ///< one of the edges; all edges of the chain have the same uses
  bool is_flipped = false;  ///< that edge, taken from its smaller vertex, runs from `high` to `low`
  /// Where the vertices are stored from `low` to `high`, if the user of the graph stores them. A chain may begin and
  /// end in the same vertex. Then one of its two directions counts as the one from `low` to `high`.
  std::uint32_t stored = kNone;
};

/// The reason why a run of edges does not end at a vertex at which the graph is cut.
enum class Stray {
  kNoPassage,  ///< the run reaches a vertex where it is not true that exactly two edges with the same uses meet
  kLoop,       ///< the run returns to itself
};

class BoundaryGraph {
 public:
  /// Errors: kCancelled, kTimeout - stopped through `control`.
  BoundaryGraph(std::size_t vertex_count, BoundingEdges bounding, RunControl& control);

  std::span<const Edge> edges() const { return bounding_.edges; }
  /// True if a bounding edge ends at the vertex.
  bool has(VertexId v) const { return node(v).degree > 0; }
  /// True if exactly two edges meet at the vertex, with the same patches on the same sides. The vertex is then inside
  /// one seam.
  bool is_passage(VertexId v) const { return node(v).degree == 2 && is_passage(v, node(v).edges[0], node(v).edges[1]); }
  /// The vertices before and after a vertex inside a seam.
  std::array<VertexId, 2> neighbours(VertexId passage) const {
    const auto& [a, b] = node(passage).edges;
    return {edges()[a].other(passage), edges()[b].other(passage)};
  }
  /// The uses of both edges at a vertex inside a seam.
  std::span<const Use> uses_at(VertexId passage) const { return edges()[node(passage).edges[0]].uses; }
  /// True if the vertex is inside a seam of that patch.
  bool is_passage_of(VertexId v, PatchId patch) const {
    return node(v).degree == 2 && has_patch(edges()[node(v).edges[0]].uses, patch);
  }

  /// Cuts the graph at all vertices v for which is_inner(v) is false.
  /// Output: on_chain(chain, its vertices from end to end) is called for each run between two such vertices;
  ///         on_stray(edge, vertex, reason) is called for edges of the other runs.
  template <class IsInner, class OnChain, class OnStray>
  void for_each_chain(RunControl& control, const IsInner& is_inner, const OnChain& on_chain,
                      const OnStray& on_stray) const {
    std::vector<bool> is_walked(edges().size(), false);
    std::vector<VertexId> run;
    StopCheck check(control);
    const auto walk = [&](VertexId start, std::uint32_t first) {
      run.assign(1, start);
      std::uint32_t e = first;
      VertexId v = start;
      for (;;) {
        check();
        is_walked[e] = true;
        v = edges()[e].other(v);
        run.push_back(v);
        if (!is_inner(v)) break;
        if (node(v).degree != 2) return on_stray(edges()[e], v, Stray::kNoPassage);
        const std::uint32_t next = node(v).edges[0] == e ? node(v).edges[1] : node(v).edges[0];
        if (is_walked[next]) return on_stray(edges()[e], v, Stray::kLoop);  // this is not an edge of a sound surface
        if (!is_passage(v, e, next)) {
          on_stray(edges()[e], v, Stray::kNoPassage);
          return on_stray(edges()[next], v, Stray::kNoPassage);
        }
        e = next;
      }
      const bool is_upwards = start < v;  // a chain that returns to its start is walked from `high` to `low`
      const bool is_flipped = (edges()[first].low == start) != is_upwards;
      on_chain(Chain{std::min(start, v), std::max(start, v), first, is_flipped}, std::span<const VertexId>(run));
    };
    for (std::uint32_t e = 0; e < edges().size(); ++e) {
      check();
      if (is_walked[e]) continue;
      if (!is_inner(edges()[e].low))
        walk(edges()[e].low, e);
      else if (!is_inner(edges()[e].high))
        walk(edges()[e].high, e);
    }
    // The remaining edges cannot be reached from a vertex at which the graph is cut.
    for (std::uint32_t e = 0; e < edges().size(); ++e) {
      check();
      if (!is_walked[e]) on_stray(edges()[e], edges()[e].low, Stray::kLoop);
    }
  }

 private:
  /// Input: a, b - edges that end at v. The edges are walked in the same sense if v is the larger end of one and the
  ///        smaller end of the other.
  bool is_passage(VertexId v, std::uint32_t a, std::uint32_t b) const {
    return have_same_uses(edges()[a].uses, edges()[b].uses, (edges()[a].low == v) == (edges()[b].low == v));
  }

  /// The number of edges that end at a vertex, and the first two of them.
  struct Node {
    std::uint32_t degree = 0;
    std::array<std::uint32_t, 2> edges{};
  };
  const Node& node(VertexId v) const { return nodes_[node_of_[v.value]]; }

  BoundingEdges bounding_;
  /// The node of each vertex. Most vertices are inside patches and share node 0, where no edge ends.
  std::vector<std::uint32_t> node_of_;
  std::vector<Node> nodes_;
};

}  // namespace remesh::verification
