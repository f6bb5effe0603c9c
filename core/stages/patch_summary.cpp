#include "core/stages/patch_summary.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/blocks.h"

namespace remesh {
namespace {

std::size_t distinct(std::vector<VertexId>& vertices) {
  tbb::parallel_sort(vertices.begin(), vertices.end());
  return static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
}

/// What some of a patch's faces add to it; local units.
struct FacesSummary {
  double area = 0, deviation = 0;
  std::vector<VertexId> essential;  ///< of their corners
};

class Summariser {
 public:
  Summariser(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
             const PatchSet& patches, const BoundaryLoops& loops, const IdVector<VertexId, std::uint8_t>& essential,
             const Ladder& ladder, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        geometry_(geometry),
        patches_(patches),
        loops_(loops),
        essential_(essential),
        ladder_(ladder),
        control_(control) {}

  PatchSummary of(PatchId p) const {
    const Plane& plane = patches_.planes[p];
    const FaceId first = patches_.faces_of(p)[0];
    PatchSummary s;
    s.normal = plane.normal;
    s.offset = dot(surface_.centre, plane.normal) + surface_.unit * dot(plane.origin, plane.normal);
    s.status = ladder_.is_kept(first)      ? PatchStatus::kKept
               : ladder_.rung()[first] > 0 ? PatchStatus::kReduced
                                           : PatchStatus::kRemeshed;
    s.reason = ladder_.reason()[first];
    s.input_faces = patches_.faces_of(p).size();
    s.loops = loops_.patch_begin[p.value + 1] - loops_.patch_begin[p.value];

    FacesSummary faces = of_faces(p);
    s.area = faces.area * surface_.unit * surface_.unit;
    s.deviation = faces.deviation * surface_.unit;
    const std::size_t vertices = distinct(faces.essential);
    s.essential_vertices = static_cast<std::uint32_t>(vertices);

    // A region with k loop corners (a vertex counts as often as loops pass it) on l loops and m points inside is
    // cut into k + 2 m + 2 l - 4 triangles.
    std::vector<VertexId> rim;
    for (std::uint32_t l = loops_.patch_begin[p.value]; l < loops_.patch_begin[p.value + 1]; ++l)
      for (const std::uint32_t h : loops_.loop(l))
        if (essential_[adjacency_.from(h)]) rim.push_back(adjacency_.from(h));
    const std::size_t corners = rim.size(), inside = vertices - distinct(rim);
    const auto triangles = static_cast<std::int64_t>(corners + 2 * inside + 2ull * s.loops) - 4;
    s.output_faces = static_cast<std::uint64_t>(std::max<std::int64_t>(1, triangles));
    return s;
  }

 private:
  FacesSummary of_faces(PatchId p) const {
    const auto faces = patches_.faces_of(p);
    const Plane& plane = patches_.planes[p];
    const auto measure = [&](std::size_t begin, std::size_t end) {
      FacesSummary sum;
      for (const FaceId f : faces.subspan(begin, end - begin)) {
        sum.area += geometry_[f].area;
        for (const VertexId v : surface_.face(f)) {
          sum.deviation = std::max(sum.deviation, std::fabs(plane.distance(surface_.local[v])));
          if (essential_[v]) sum.essential.push_back(v);
        }
      }
      return sum;
    };
    FacesSummary all;
    for (const FacesSummary& sum : map_blocks<FacesSummary>(faces.size(), kItemsPerBlock, control_, measure)) {
      all.area += sum.area;
      all.deviation = std::max(all.deviation, sum.deviation);
      all.essential.insert(all.essential.end(), sum.essential.begin(), sum.essential.end());
    }
    return all;
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const FaceGeometries& geometry_;
  const PatchSet& patches_;
  const BoundaryLoops& loops_;
  const IdVector<VertexId, std::uint8_t>& essential_;
  const Ladder& ladder_;
  RunControl& control_;
};

}  // namespace

PatchSummaries summarise_patches(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry,
                                 const PatchSet& patches, const BoundaryLoops& loops,
                                 const IdVector<VertexId, std::uint8_t>& essential, const Ladder& ladder,
                                 RunControl& control) {
  const Summariser summariser(surface, adjacency, geometry, patches, loops, essential, ladder, control);
  constexpr std::size_t kPatches = 256;
  PatchSummaries result;
  result.patches.resize(patches.count());
  for_blocks(patches.count(), kPatches, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) result.patches[p] = summariser.of(PatchId(p));
  });
  for (const PatchSummary& s : result.patches) {
    result.triangles += s.output_faces;
    result.volume_bound += s.area * s.deviation;
  }
  return result;
}

}  // namespace remesh
