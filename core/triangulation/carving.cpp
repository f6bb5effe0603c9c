#include "core/triangulation/carving.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

enum Mark : std::uint8_t { kUnknown = 2, kInside = 1, kOutside = 0 };

}  // namespace

TriangulationOutcome carving(std::span<const Segment> loop_edges, Triangulation2d& mesh, RunControl& control) {
  // Sort the loop edges by their tail, and those of one tail by their head, so that a directed edge can be looked up.
  const std::uint32_t half_edges = mesh.half_edge_count();
  std::uint32_t points = 0;
  for (std::uint32_t h = 0; h < half_edges; ++h) points = std::max(points, mesh.from(h) + 1);
  std::vector<std::uint32_t> begin(points + 1, 0);
  StopCheck check(control);
  for (const auto& [u, v] : loop_edges) ++begin[u + 1];
  for (std::uint32_t p = 0; p < points; ++p) begin[p + 1] += begin[p];
  std::vector<std::uint32_t> heads(loop_edges.size());
  {
    std::vector<std::uint32_t> at(begin.begin(), begin.end() - 1);
    for (const auto& [u, v] : loop_edges) heads[at[u]++] = v;
    for (std::uint32_t p = 0; p < points; ++p) {
      check();
      std::sort(heads.begin() + begin[p], heads.begin() + begin[p + 1]);
    }
  }
  const auto is_loop_edge = [&](std::uint32_t u, std::uint32_t v) {
    return std::binary_search(heads.begin() + begin[u], heads.begin() + begin[u + 1], v);
  };

  std::vector<std::uint8_t> mark(mesh.triangle_count(), kUnknown);
  std::vector<std::uint32_t> stack;
  bool consistent = true;
  const auto set = [&](std::uint32_t triangle, Mark value) {
    if (mark[triangle] == kUnknown) {
      mark[triangle] = value;
      stack.push_back(triangle);
    } else if (mark[triangle] != value) {
      consistent = false;
    }
  };
  const auto flood = [&] {
    while (!stack.empty()) {
      check();
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h)
        if (!mesh.is_constrained(h) && mesh.twin(h) != kNoHalfEdge) set(mesh.twin(h) / 3, static_cast<Mark>(mark[t]));
    }
  };
  for (std::uint32_t h = 0; h < half_edges && consistent; ++h) {
    if (h % 4096 == 0) control.check_and_move();
    if (mesh.is_constrained(h)) {
      const bool forwards = is_loop_edge(mesh.from(h), mesh.to(h));
      set(h / 3, forwards ? kInside : kOutside);
    } else if (mesh.twin(h) == kNoHalfEdge) {
      set(h / 3, kOutside);
    }
    flood();
  }
  if (!consistent) return TriangulationOutcome::kInconsistentLoops;
  // Every triangle has a mark now. Without constraints, all of them were reached from the hull. With constraints, each
  // region has at least one constrained edge or hull edge, from which it was marked.
  mesh.compact(mark);
  return TriangulationOutcome::kDone;
}

}  // namespace remesh
