#include "core/mesh/pinched_vertices.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <iterator>
#include <numeric>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/base/union_find.h"

namespace remesh {
namespace {

class PinchSearch {
 public:
  PinchSearch(const Surface& surface, const Adjacency& edges, RunControl& control)
      : surface_(surface), edges_(edges), control_(control) {}

  std::vector<VertexId> run() {
    // Most vertices have one fan, and one walk around the vertex meets all its faces. If all walks together meet all
    // corners, then each walk met all faces of its vertex, and no vertex is pinched.
    find_corners();
    const auto met = map_blocks<std::size_t>(surface_.vertex_count(), kItemsPerBlock, control_,
                                             [&](std::size_t begin, std::size_t end) {
                                               std::size_t corners = 0;
                                               StopCheck check(control_);
                                               for (std::size_t v = begin; v < end; ++v) corners += walk(v, check);
                                               return corners;
                                             });
    if (std::accumulate(met.begin(), met.end(), std::size_t{0}) == surface_.corners.size()) return {};
    std::vector<std::uint32_t> degree(surface_.vertex_count(), 0);
    StopCheck check(control_);
    for (const VertexId v : surface_.corners) {
      check();
      ++degree[v.value];
    }
    std::vector<VertexId> odd;
    for (std::size_t v = 0; v < degree.size(); ++v) {
      check();
      if (walk(v, check) != degree[v]) odd.push_back(VertexId(v));
    }
    return with_several_fans(odd, std::move(degree));
  }

 private:
  /// Finds one corner of each vertex. It makes no difference which one.
  void find_corners() {
    some_.assign(surface_.vertex_count(), kNone);
    for_blocks(surface_.corners.size(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t h = begin; h < end; ++h)
        std::atomic_ref(some_[surface_.corners[h].value])
            .store(static_cast<std::uint32_t>(h), std::memory_order_relaxed);
    });
  }

  /// Counts the corners at a vertex that can be reached from one of them over edges that have two faces with the same
  /// orientation.
  std::uint32_t walk(std::size_t vertex, StopCheck& check) const {
    const std::uint32_t start = some_[vertex];
    if (start == kNone) return 0;
    std::uint32_t count = 1;
    std::uint32_t h = edges_.twin(edges_.previous(start));
    for (; h != kNone && h != start; h = edges_.twin(edges_.previous(h))) {
      check();
      ++count;
    }
    if (h == start) return count;
    for (h = edges_.twin(start); h != kNone; h = edges_.twin(edges_.next(h))) {
      check();
      ++count;
    }
    return count;
  }

  /// Returns the vertices of `odd` that have several fans. It joins the corners at these vertices over edges of any
  /// kind, and counts the connected parts. `fans` is the number of corners of each vertex.
  std::vector<VertexId> with_several_fans(const std::vector<VertexId>& odd, std::vector<std::uint32_t> fans) const {
    std::vector<std::uint8_t> is_odd(surface_.vertex_count(), 0);
    for (const VertexId v : odd) is_odd[v.value] = 1;
    UnionFind joined(surface_.corners.size());
    StopCheck check(control_);
    const auto corner_at = [&](std::uint32_t h, VertexId v) { return edges_.from(h) == v ? h : edges_.next(h); };
    for (std::uint32_t e = 0; e < edges_.edge_count(); ++e) {
      if (e % kItemsPerBlock == 0) control_.check_and_move();
      const auto around = edges_.half_edges(EdgeId(e));
      for (const VertexId v : {edges_.from(around[0]), edges_.to(around[0])}) {
        if (!is_odd[v.value]) continue;
        if (edges_.from(around[0]) == edges_.to(around[0])) {  // a repeated corner is no edge
          fans[v.value] -= joined.join(around[0], edges_.next(around[0]));
          break;
        }
        for (const std::uint32_t h : around) {
          check();
          fans[v.value] -= joined.join(corner_at(around[0], v), corner_at(h, v));
        }
      }
    }
    std::vector<VertexId> pinched;
    std::copy_if(odd.begin(), odd.end(), std::back_inserter(pinched), [&](VertexId v) { return fans[v.value] > 1; });
    return pinched;
  }

  const Surface& surface_;
  const Adjacency& edges_;
  RunControl& control_;
  std::vector<std::uint32_t> some_;
};

}  // namespace

std::vector<VertexId> pinched_vertices(const Surface& surface, const Adjacency& edges, RunControl& control) {
  return PinchSearch(surface, edges, control).run();
}

}  // namespace remesh
