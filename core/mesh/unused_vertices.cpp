#include "core/mesh/unused_vertices.h"

#include <atomic>
#include <span>
#include <utility>
#include <vector>

#include "core/base/blocks.h"

namespace remesh {

void drop_unused_vertices(Surface& surface, RunControl& control) {
  constexpr std::uint32_t kBetweenChecks = 1 << 14;
  std::vector<VertexId> renumbered(surface.vertex_count());
  for_blocks(surface.corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (const VertexId v : surface.corners.items().subspan(begin, end - begin))
      std::atomic_ref(renumbered[v.value].value).store(v.value, std::memory_order_relaxed);
  });
  std::vector<Vec3> positions;
  positions.reserve(surface.vertex_count());
  std::uint32_t used = 0;
  for (std::uint32_t v = 0; v < renumbered.size(); ++v) {
    if (v % kBetweenChecks == 0) control.check_and_move();
    if (!renumbered[v].is_valid()) continue;
    renumbered[v] = VertexId(used);
    positions.push_back(surface.positions[VertexId(v)]);
    surface.local[VertexId(used)] = surface.local[VertexId(v)];
    surface.vertex_source[VertexId(used)] = surface.vertex_source[VertexId(v)];
    ++used;
  }
  surface.positions = std::move(positions);
  surface.local.resize(used);
  surface.vertex_source.resize(used);
  surface.corners.change([&](std::vector<VertexId>& corners) {
    for_blocks(corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (VertexId& v : std::span(corners).subspan(begin, end - begin)) v = renumbered[v.value];
    });
  });
}

}  // namespace remesh
