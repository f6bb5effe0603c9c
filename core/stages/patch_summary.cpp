#include "core/stages/patch_summary.h"

#include <algorithm>
#include <cmath>

namespace remesh {

PatchSummaries summarise_patches(const Surface& surface, const Adjacency& adjacency,
                                 const IdVector<FaceId, FaceGeometry>& geometry, const PatchSet& patches,
                                 const BoundaryLoops& loops, const IdVector<VertexId, std::uint8_t>& essential,
                                 const Ladder& ladder, RunControl& control) {
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
    for (const FaceId f : patches.faces_of(p)) {
      area += geometry[f].area;
      for (const VertexId v : surface.face(f)) {
        s.deviation = std::max(s.deviation, std::fabs(plane.distance(surface.local[v])));
        if (!essential[v] || counted[v] == p) continue;
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
