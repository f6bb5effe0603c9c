#include "core/patches/chains/boundary_chains.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// Walks the loops of the wanted patches.
class ChainFinder {
 public:
  ChainFinder(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches, const BoundaryLoops& loops,
              const EssentialVertices& essential, std::span<const VertexId> pinched,
              const IdVector<PatchId, std::uint8_t>& is_wanted, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        patches_(patches),
        loops_(loops),
        essential_(essential),
        is_wanted_(is_wanted),
        check_(control),
        control_(control) {
    mark_corners(pinched);
  }

  BoundaryChains run() {
    for (PatchId p(0); p.value < patches_.count(); ++p.value) {
      if (!is_wanted_[p]) continue;
      for (std::uint32_t l = loops_.patch_begin[p.value]; l < loops_.patch_begin[p.value + 1]; ++l)
        split_loop(loops_.loop(l));
    }
    return sorted();
  }

 private:
  const Vec3& at(VertexId v) const { return surface_.positions[v]; }

  void mark_corners(std::span<const VertexId> pinched) {
    std::vector<std::uint8_t> edges(surface_.vertex_count(), 0);
    for (const std::uint32_t h : loops_.half_edges) {
      check_();
      if (!is_first(h)) continue;
      for (const VertexId v : {adjacency_.from(h), adjacency_.to(h)})
        if (edges[v.value] < 3) ++edges[v.value];
    }
    is_corner_.assign(surface_.vertex_count(), 0);
    for (std::size_t v = 0; v < edges.size(); ++v) is_corner_[VertexId(v)] = edges[v] != 2;
    for (const VertexId v : pinched) is_corner_[v] = 1;
  }

  /// Returns whether a half-edge is the first one of its edge.
  bool is_first(std::uint32_t h) const {
    const std::uint32_t twin = adjacency_.twin(h);
    return twin != kNone ? h < twin : adjacency_.half_edges(adjacency_.edge_of(h))[0] == h;
  }

  /// Returns whether a half-edge is the first one of its edge in a wanted patch. So each chain is taken from one side.
  bool is_first_wanted(std::uint32_t h) const {
    const auto is_earlier = [&](std::uint32_t other) {
      return other < h && is_wanted_[patches_.of_face[adjacency_.face_of(other)]];
    };
    const std::uint32_t twin = adjacency_.twin(h);
    if (twin != kNone) return !is_earlier(twin);
    const auto all = adjacency_.half_edges(adjacency_.edge_of(h));
    return std::none_of(all.begin(), all.end(), is_earlier);
  }

  void split_loop(std::span<const std::uint32_t> loop) {
    const auto begins_at_corner = [&](std::uint32_t h) { return is_corner_[adjacency_.from(h)] != 0; };
    const auto corner = std::find_if(loop.begin(), loop.end(), begins_at_corner);
    const auto first = static_cast<std::size_t>(corner == loop.end() ? smallest(loop) : corner - loop.begin());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      check_();
      const std::uint32_t h = loop[(first + i) % loop.size()];
      if (run_.empty() || essential_[adjacency_.from(h)]) {
        run_.push_back({adjacency_.from(h), last_, h});
      }
      last_ = h;
      if (i + 1 == loop.size() || is_corner_[adjacency_.to(h)]) end_run(corner == loop.end());
    }
  }

  /// Returns the place in a loop of the half-edge that begins at the smallest essential vertex.
  std::ptrdiff_t smallest(std::span<const std::uint32_t> loop) const {
    const auto is_smaller = [&](std::uint32_t g, std::uint32_t h) {
      const VertexId a = adjacency_.from(g), b = adjacency_.from(h);
      if (essential_[a] != essential_[b]) return essential_[a];
      return at(a) < at(b);
    };
    return std::min_element(loop.begin(), loop.end(), is_smaller) - loop.begin();
  }

  void end_run(bool is_ring) {
    run_.push_back({adjacency_.to(last_), last_, kNone});
    if (is_ring) {
      run_.front().before = run_.back().before;
      run_.back().after = run_.front().after;
    }
    const std::size_t last = run_.size() - 1;
    const bool is_backward =
        is_closed(run_) ? at(run_[last - 1].vertex) < at(run_[1].vertex) : at(run_[last].vertex) < at(run_[0].vertex);
    if (is_backward) {
      std::reverse(run_.begin(), run_.end());
      for (ChainNode& node : run_) std::swap(node.before, node.after);
    }
    if (is_first_wanted(run_.front().after)) {
      chains_.nodes.insert(chains_.nodes.end(), run_.begin(), run_.end());
      chains_.begin.push_back(static_cast<std::uint32_t>(chains_.nodes.size()));
    }
    run_.clear();
    last_ = kNone;
  }

  BoundaryChains sorted() {
    std::vector<std::uint32_t> order(chains_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](std::uint32_t c) { return std::pair(at(chains_[c][0].vertex), at(chains_[c][1].vertex)); };
    sort_stoppable(order.begin(), order.end(), control_, [&](std::uint32_t c, std::uint32_t d) {
      const auto of_c = key(c), of_d = key(d);
      return of_c != of_d ? of_c < of_d : c < d;
    });
    BoundaryChains result;
    result.nodes.reserve(chains_.nodes.size());
    for (const std::uint32_t c : order) {
      check_();
      result.nodes.insert(result.nodes.end(), chains_[c].begin(), chains_[c].end());
      result.begin.push_back(static_cast<std::uint32_t>(result.nodes.size()));
    }
    return result;
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const PatchSet& patches_;
  const BoundaryLoops& loops_;
  const EssentialVertices& essential_;
  const IdVector<PatchId, std::uint8_t>& is_wanted_;
  StopCheck check_;
  RunControl& control_;
  IdVector<VertexId, std::uint8_t> is_corner_;
  std::vector<ChainNode> run_;  ///< the chain that is being walked
  std::uint32_t last_ = kNone;  ///< its last half-edge so far
  BoundaryChains chains_;
};

}  // namespace

std::vector<std::uint32_t> half_edges_along(const Adjacency& adjacency, std::uint32_t half_edge) {
  const std::uint32_t twin = adjacency.twin(half_edge);
  if (twin != kNone) return {half_edge, twin};
  const auto all = adjacency.half_edges(adjacency.edge_of(half_edge));
  return {all.begin(), all.end()};
}

BoundaryChains boundary_chains(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                               const BoundaryLoops& loops, const EssentialVertices& essential,
                               std::span<const VertexId> pinched, const IdVector<PatchId, std::uint8_t>& is_wanted,
                               RunControl& control) {
  return ChainFinder(surface, adjacency, patches, loops, essential, pinched, is_wanted, control).run();
}

}  // namespace remesh
