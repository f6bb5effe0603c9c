#include "core/verify/edge_table.h"

#include <algorithm>

#include "core/base/blocks.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kBlock = 8192;

}  // namespace

bool have_same_uses(std::span<const Use> a, std::span<const Use> b, bool is_flipped) {
  if (a.size() != b.size()) return false;
  for (std::size_t begin = 0; begin < a.size();) {
    const PatchId patch = a[begin].patch();
    std::size_t end = begin;
    std::size_t forward_a = 0, forward_b = 0;
    for (; end < a.size() && a[end].patch() == patch; ++end) {
      if (b[end].patch() != patch) return false;
      forward_a += a[end].is_forward();
      forward_b += b[end].is_forward();
    }
    if (forward_a != (is_flipped ? end - begin - forward_b : forward_b)) return false;
    begin = end;
  }
  return true;
}

bool has_patch(std::span<const Use> uses, PatchId patch) {
  const auto found =
      std::partition_point(uses.begin(), uses.end(), [patch](const Use& u) { return u.patch() < patch; });
  return found != uses.end() && found->patch() == patch;
}

EdgeTable::EdgeTable(std::size_t vertex_count, const Faces& faces, RunControl& control)
    : bucket_(vertex_count + 1, 0), uses_(faces.corners.size()) {
  const auto for_each_half_edge = [&](const auto& visit) {
    for (std::size_t f = 0; f < faces.count(); ++f) {
      if (f % kBlock == 0) control.check();
      const std::uint32_t begin = faces.face_begin[f], end = faces.face_begin[f + 1];
      for (std::uint32_t h = begin; h < end; ++h)
        visit(f, h, faces.corners[h], faces.corners[h + 1 == end ? begin : h + 1]);
    }
  };
  // A counting sort by the smaller vertex, then a small sort within each bucket.
  for_each_half_edge(
      [&](std::size_t, std::uint32_t, VertexId from, VertexId to) { ++bucket_[std::min(from, to).value + 1]; });
  for (std::size_t v = 0; v < vertex_count; ++v) bucket_[v + 1] += bucket_[v];
  std::vector<std::uint32_t> at(bucket_.begin(), bucket_.end() - 1);
  for_each_half_edge([&](std::size_t f, std::uint32_t h, VertexId from, VertexId to) {
    uses_[at[std::min(from, to).value]++] = {std::max(from, to), faces.patch[f], h, from < to};
  });
  for_blocks(vertex_count, kBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) std::sort(uses_.begin() + bucket_[v], uses_.begin() + bucket_[v + 1]);
  });
}

std::span<const Use> EdgeTable::find(VertexId a, VertexId b) const {
  const VertexId low = std::min(a, b), high = std::max(a, b);
  const auto first = uses_.begin() + bucket_[low.value], last = uses_.begin() + bucket_[low.value + 1];
  const auto begin = std::partition_point(first, last, [high](const Use& use) { return use.high < high; });
  const auto end = std::partition_point(begin, last, [high](const Use& use) { return use.high == high; });
  return {begin, end};
}

EdgeCounts list_boundary(const EdgeTable& table, RunControl& control, std::vector<Edge>& boundary) {
  struct Block {
    EdgeCounts counts;
    std::vector<Edge> boundary;
  };
  const auto blocks = map_blocks<Block>(table.vertex_count(), kBlock, control, [&](std::size_t begin, std::size_t end) {
    Block block;
    table.for_each_edge(begin, end, [&](const Edge& edge) {
      ++block.counts.edges;
      if (edge.uses.size() != 2)
        block.counts.is_closed = block.counts.is_consistent = false;
      else if (edge.uses[0].is_forward() == edge.uses[1].is_forward())
        block.counts.is_consistent = false;
      if (!edge.is_interior()) block.boundary.push_back(edge);
    });
    return block;
  });
  EdgeCounts counts;
  for (const Block& block : blocks) {
    counts.edges += block.counts.edges;
    counts.is_closed = counts.is_closed && block.counts.is_closed;
    counts.is_consistent = counts.is_consistent && block.counts.is_consistent;
    boundary.insert(boundary.end(), block.boundary.begin(), block.boundary.end());
  }
  return counts;
}

}  // namespace remesh::verification
