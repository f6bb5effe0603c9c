#include "core/refinement/rounds/refined_patches.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/parallel_free.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// The numbers of patches and of segments in a task. The first is small because a patch may have thousands of
/// triangles.
constexpr std::size_t kPatchesPerTask = 16;
constexpr std::size_t kSegmentsPerTask = 1024;

/// Returns the number of the first new vertex on each segment, and behind the last one the number of all of them.
std::vector<std::uint32_t> first_cut_of_segments(const SegmentTable& segments, const SegmentCuts& cuts,
                                                 RunControl& control) {
  std::vector<std::uint32_t> first(segments.size() + 1, 0);
  StopCheck check(control);
  for (std::size_t s = 0; s < segments.size(); ++s) {
    check();
    first[s + 1] = first[s] + static_cast<std::uint32_t>(cuts[SegmentId(s)].size());
  }
  return first;
}

}  // namespace

std::size_t count_unplaced(const PatchMesh& patch) {
  return static_cast<std::size_t>(
      std::count_if(patch.vertices.begin(), patch.vertices.end(), [](VertexId v) { return !v.is_valid(); }));
}

std::size_t place_inner_vertices(const Surface& surface, const PatchChart& chart, PatchMesh& patch, std::size_t first,
                                 std::vector<Vec3>& new_positions) {
  const std::size_t begin = first;
  for (std::size_t v = 0; v < patch.vertices.size(); ++v) {
    if (patch.vertices[v].is_valid()) continue;
    patch.vertices[v] = VertexId(surface.vertex_count() + first);
    new_positions[first++] = chart.new_position(patch.uv[v]);
  }
  return first - begin;
}

PatchBackup collect_refined(const RefinementInput& input, const SegmentTable& segments, const SegmentCuts& cuts,
                            const TriangulatedPatches& triangulated, PatchRefiners& refiners, bool are_refiners_kept,
                            Refinement& result, RunControl& control) {
  const std::size_t n = triangulated.size(), old = input.surface.vertex_count();
  const std::vector<std::uint32_t> first_cut = first_cut_of_segments(segments, cuts, control);
  result.first_inner = first_cut.back();
  std::vector<PatchId> ids =
      select_ids<PatchId>(n, kItemsPerBlock, control, [&](std::size_t p) { return refiners[PatchId(p)] != nullptr; });
  FreedInParallel<PatchMesh> all;
  std::vector<PatchMesh>& meshes = all.items;
  meshes.resize(ids.size());
  std::vector<std::vector<UnrefinedReason>> reasons(ids.size());
  // First, these are the counts for each patch that is refined, and for each patch. Then they become the sums over all
  // patches before it.
  std::vector<std::size_t> first_inner(ids.size() + 1, 0), first_triangle(n + 1, 0);
  for_blocks(n, kItemsPerBlock, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) first_triangle[p + 1] = triangulated.meshes[PatchId(p)].mesh.triangle_count();
  });
  for_blocks(ids.size(), kPatchesPerTask, control, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      std::unique_ptr<PatchRefiner>& refiner = refiners[ids[i]];
      PatchRefiner::Refined patch = refiner->finish();
      if (!are_refiners_kept) refiner.reset();
      for (std::size_t v = 0; v < patch.cuts.size(); ++v) {
        const Cut& cut = patch.cuts[v];
        if (!cut.segment.is_valid()) continue;
        const std::vector<double>& of_segment = cuts[cut.segment];
        const auto k = std::lower_bound(of_segment.begin(), of_segment.end(), cut.t) - of_segment.begin();
        patch.patch.vertices[v] = VertexId(old + first_cut[cut.segment.value] + static_cast<std::size_t>(k));
      }
      first_inner[i + 1] = count_unplaced(patch.patch);
      first_triangle[ids[i].value + 1] = patch.patch.mesh.triangle_count();
      reasons[i] = std::move(patch.reason);
      meshes[i] = std::move(patch.patch);
    }
  });
  first_inner[0] = result.first_inner;
  std::partial_sum(first_inner.begin(), first_inner.end(), first_inner.begin());
  std::partial_sum(first_triangle.begin(), first_triangle.end(), first_triangle.begin());
  result.new_positions.resize(first_inner.back());
  result.reason.assign(first_triangle[n], UnrefinedReason::kSizeFloor);
  StopCheck check(control);
  for (std::size_t p = 0; p < n; ++p) {
    check();
    if (input.is_frozen[PatchId(p)] != 0)
      std::fill(result.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p]),
                result.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[p + 1]),
                UnrefinedReason::kBoundaryLocked);
  }
  for_blocks(segments.size(), kSegmentsPerTask, control, [&](std::size_t s, std::size_t end) {
    for (; s < end; ++s) {
      const std::vector<double>& of_segment = cuts[SegmentId(s)];
      for (std::size_t k = 0; k < of_segment.size(); ++k)
        result.new_positions[first_cut[s] + k] = segments.position(SegmentId(s), of_segment[k]);
    }
  });
  for_blocks(ids.size(), kPatchesPerTask, control, [&](std::size_t i, std::size_t end) {
    for (; i < end; ++i) {
      place_inner_vertices(input.surface, triangulated.charts[ids[i]], meshes[i], first_inner[i], result.new_positions);
      std::copy(reasons[i].begin(), reasons[i].end(),
                result.reason.begin() + static_cast<std::ptrdiff_t>(first_triangle[ids[i].value]));
    }
  });
  return {std::move(ids), std::move(meshes)};
}

}  // namespace remesh
