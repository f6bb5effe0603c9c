#include "core/stages/patch_summary.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/blocks.h"

namespace remesh {
namespace {

/// What some of a patch's faces add to it; local units.
struct FacesSummary {
  double area = 0, deviation = 0;
  std::vector<VertexId> essential;  ///< of their corners
};

}  // namespace

PatchSummaries summarise_patches(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                                 const PatchSet& patches, const BoundaryLoops& loops,
                                 const IdVector<VertexId, std::uint8_t>& essential, const Ladder& ladder,
                                 RunControl& control) {
  PatchSummaries result;
  result.patches.reserve(patches.count());
  // The patch that has counted a vertex last.
  IdVector<VertexId, PatchId> counted(surface.vertex_count());
  for (std::uint32_t i = 0; i < patches.count(); ++i) {
    if (i % 4096 == 0) control.check();
    const PatchId p(i);
    const Plane& plane = patches.planes[p];
    const FaceId first = patches.faces_of(p)[0];
    PatchSummary s;
    s.normal = plane.normal;
    s.offset = dot(surface.centre, plane.normal) + surface.unit * dot(plane.origin, plane.normal);
    s.status = ladder.is_kept(first)      ? PatchStatus::kKept
               : ladder.rung()[first] > 0 ? PatchStatus::kReduced
                                          : PatchStatus::kRemeshed;
    s.reason = ladder.reason()[first];
    s.input_faces = patches.faces_of(p).size();
    s.loops = loops.patch_begin[i + 1] - loops.patch_begin[i];

    // A region with k loop corners (a vertex counts as often as loops pass it) on l loops and m points inside is
    // cut into k + 2 m + 2 l - 4 triangles.
    std::uint64_t corners = 0;
    for (std::uint32_t l = loops.patch_begin[i]; l < loops.patch_begin[i + 1]; ++l)
      for (const std::uint32_t h : loops.loop(l)) {
        const VertexId v = adjacency.from(h);
        if (!essential[v]) continue;
        ++corners;
        if (counted[v] == p) continue;
        counted[v] = p;
        ++s.essential_vertices;
      }
    std::uint64_t inside = 0;
    double area = 0;
    const auto measure = [&](std::size_t begin, std::size_t end) {
      FacesSummary sum;
      for (const FaceId f : patches.faces_of(p).subspan(begin, end - begin)) {
        sum.area += geometry[f].area;
        for (const VertexId v : surface.face(f)) {
          sum.deviation = std::max(sum.deviation, std::fabs(plane.distance(surface.local[v])));
          if (essential[v] && counted[v] != p) sum.essential.push_back(v);
        }
      }
      return sum;
    };
    for (const FacesSummary& sum : map_blocks<FacesSummary>(s.input_faces, kItemsPerBlock, control, measure)) {
      area += sum.area;
      s.deviation = std::max(s.deviation, sum.deviation);
      for (const VertexId v : sum.essential) {
        if (counted[v] == p) continue;
        counted[v] = p;
        ++inside;
      }
    }
    s.essential_vertices += static_cast<std::uint32_t>(inside);
    s.area = area * surface.unit * surface.unit;
    s.deviation *= surface.unit;
    const auto triangles = static_cast<std::int64_t>(corners + 2 * inside + 2ull * s.loops) - 4;
    s.output_faces = static_cast<std::uint64_t>(std::max<std::int64_t>(1, triangles));
    result.triangles += s.output_faces;
    result.volume_bound += s.area * s.deviation;
    result.patches.push_back(s);
  }
  return result;
}

}  // namespace remesh
