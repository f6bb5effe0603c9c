#include "core/patches/planar/patch_summary.h"

#include <algorithm>
#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// Limits measures of a model near the largest double to that double, like those of the whole surface.
double within_double(double measure) { return std::min(measure, DBL_MAX); }

std::size_t distinct(std::vector<VertexId>& vertices, RunControl& control) {
  sort_stoppable(vertices.begin(), vertices.end(), control);
  return static_cast<std::size_t>(std::unique(vertices.begin(), vertices.end()) - vertices.begin());
}

constexpr std::size_t kPatchesPerBlock = 256;

/// Summarises one patch after the other.
class Summariser {
 public:
  Summariser(const Surface& surface, const Adjacency& adjacency, const std::vector<double>& areas,
             const PatchSet& patches, const BoundaryLoops& loops, const EssentialVertices& essential,
             const SurfaceRungs& rungs, RunControl& control)
      : surface_(surface),
        adjacency_(adjacency),
        areas_(areas),
        patches_(patches),
        loops_(loops),
        essential_(essential),
        rungs_(rungs),
        control_(control) {}

  PatchSummary of(PatchId p) {
    control_.check();
    const Plane& plane = patches_.planes[p];
    const FaceId first = patches_.faces_of(p)[0];
    PatchSummary s;
    s.normal = plane.normal;
    s.offset = dot(surface_.centre, plane.normal) + surface_.unit * dot(plane.origin, plane.normal);
    s.status = rungs_.is_face_kept(first) ? PatchStatus::kKept
               : rungs_.rung[first] > 0   ? PatchStatus::kReduced
                                          : PatchStatus::kRemeshed;
    s.reason = rungs_.reason_of(first);
    surface_.for_each_source(patches_.faces_of(p), [&](FaceId) { ++s.input_faces; });
    s.loops = loops_.patch_begin[p.value + 1] - loops_.patch_begin[p.value];

    s.area = within_double(areas_[p.value] * surface_.unit * surface_.unit);
    s.deviation = patches_.deviation[p] * surface_.unit;

    // A region with k loop corners on l loops and m points inside is cut into k + 2 m + 2 l - 4 triangles. A vertex
    // counts in k as often as loops pass it.
    rim_.clear();
    StopCheck check(control_);
    for (std::uint32_t l = loops_.patch_begin[p.value]; l < loops_.patch_begin[p.value + 1]; ++l)
      for (const std::uint32_t h : loops_.loop(l)) {
        check();
        if (essential_[adjacency_.from(h)]) rim_.push_back(adjacency_.from(h));
      }
    const std::size_t corners = rim_.size(), on_rim = distinct(rim_, control_);
    const std::size_t vertices = essential_.are_on_loops ? on_rim : count_essential(p), inside = vertices - on_rim;
    s.essential_vertices = static_cast<std::uint32_t>(vertices);
    const auto triangles = static_cast<std::int64_t>(corners + 2 * inside + 2ull * s.loops) - 4;
    s.output_faces = static_cast<std::uint32_t>(std::max<std::int64_t>(1, triangles));
    return s;
  }

 private:
  /// Counts the essential vertices among all corners of the patch's faces.
  std::size_t count_essential(PatchId p) {
    corners_.clear();
    StopCheck check(control_);
    for (const FaceId f : patches_.faces_of(p))
      for (const VertexId v : surface_.face(f)) {
        check();
        if (essential_[v]) corners_.push_back(v);
      }
    return distinct(corners_, control_);
  }

  const Surface& surface_;
  const Adjacency& adjacency_;
  const std::vector<double>& areas_;
  const PatchSet& patches_;
  const BoundaryLoops& loops_;
  const EssentialVertices& essential_;
  const SurfaceRungs& rungs_;
  RunControl& control_;
  // The following is scratch memory for one patch.
  std::vector<VertexId> rim_;      ///< essential vertices of its loops
  std::vector<VertexId> corners_;  ///< essential vertices of its faces
};

}  // namespace

std::string_view status_name(PatchStatus status) {
  switch (status) {
    case PatchStatus::kRemeshed: return "remeshed";
    case PatchStatus::kReduced: return "reduced";
    case PatchStatus::kKept: return "kept";
  }
  return "";
}

std::vector<double> patch_areas(const PatchSet& patches, const FaceGeometries& geometry, RunControl& control) {
  const auto sum = [&](std::span<const FaceId> faces) {
    double area = 0;
    for (const FaceId f : faces) area += geometry[f].area;
    return area;
  };
  std::vector<double> areas(patches.count(), 0);
  for_blocks(patches.count(), kPatchesPerBlock, control, [&](std::size_t p, std::size_t end) {
    for (; p < end; ++p) {
      const auto faces = patches.faces_of(PatchId(p));
      if (faces.size() <= kItemsPerBlock) {  // most patches are small, and there may be as many as faces
        areas[p] = sum(faces);
        continue;
      }
      const auto of_block = [&](std::size_t first, std::size_t last) {
        return sum(faces.subspan(first, last - first));
      };
      for (const double area : map_blocks<double>(faces.size(), kItemsPerBlock, control, of_block)) areas[p] += area;
    }
  });
  return areas;
}

PatchSummaries summarise_patches(const Surface& surface, const Adjacency& adjacency, const std::vector<double>& areas,
                                 const PatchSet& patches, const BoundaryLoops& loops,
                                 const EssentialVertices& essential, const SurfaceRungs& rungs, RunControl& control) {
  PatchSummaries result;
  result.patches.resize(patches.count());
  for_blocks(patches.count(), kPatchesPerBlock, control, [&](std::size_t p, std::size_t end) {
    Summariser summariser(surface, adjacency, areas, patches, loops, essential, rungs, control);
    for (; p < end; ++p) result.patches[p] = summariser.of(PatchId(p));
  });
  for (const PatchSummary& s : result.patches) {
    result.triangles += s.output_faces;
    result.volume_bound = within_double(result.volume_bound + 2 * s.area * s.deviation);
  }
  return result;
}

}  // namespace remesh
