#include "core/patches/meshing/partition.h"

#include <utility>

#include "core/base/blocks.h"
#include "core/base/tolerance.h"
#include "core/patches/planar/patches.h"

namespace remesh {
namespace {

std::vector<PatchId> find_patches_with_thin_faces(const FaceGeometries& geometry, const PatchSet& patches,
                                                  double tolerance, RunControl& control) {
  std::vector<PatchId> found;
  const auto is_thin = [&](std::size_t f) { return geometry[FaceId(f)].height < kThinFace * tolerance; };
  for (const FaceId f : select_ids<FaceId>(geometry.size(), kItemsPerBlock, control, is_thin))
    found.push_back(patches.of_face[f]);
  return found;
}

}  // namespace

Partition make_partition(Prepared& prepared, double plane_tolerance, const Options& options, const SurfaceRungs& rungs,
                         Regions& regions, Stopwatch& watch, RunControl& control) {
  const Surface& surface = prepared.surface();
  const double tolerance = plane_tolerance / surface.unit;
  const Adjacency& adjacency = prepared.adjacency(control);
  Partition result;
  // Section 2: find faces that lie in one plane.
  watch.enter(Stage::kRegions);
  coplanar_regions(
      surface, adjacency, prepared.geometry(control),
      {tolerance, options.normal_tolerance, &rungs.zone, &rungs.rung, (1 / surface.unit) * prepared.printed_steps},
      regions, control);
  // Section 3: find the connected pieces of these.
  watch.enter(Stage::kPatches);
  result.patches = patches(surface, adjacency, regions, control);
  const std::vector<double> areas = patch_areas(result.patches, prepared.geometry(control), control);
  result.with_thin_faces = find_patches_with_thin_faces(prepared.geometry(control), result.patches, tolerance, control);
  // Most runs do not come back here, and the geometry is as large as all the rest of the surface.
  prepared.free_geometry();
  // Section 4: find their boundaries, and the vertices on these that cannot be left out.
  watch.enter(Stage::kLoops);
  result.loops = boundary_loops(surface, adjacency, result.patches, control);
  watch.enter(Stage::kEssentialVertices);
  result.essential = essential_vertices(surface, adjacency, result.loops, rungs.is_forced, prepared.pinched(control),
                                        tolerance, control);
  result.summaries =
      summarise_patches(surface, adjacency, areas, result.patches, result.loops, result.essential, rungs, control);
  return result;
}

PatchSet take_joined_patches(Partition& partition, Prepared& prepared, CurvedPatches& joined, double plane_tolerance,
                             const SurfaceRungs& rungs, RunControl& control) {
  const Surface& surface = prepared.surface();
  const Adjacency& adjacency = prepared.adjacency(control);
  const double tolerance = plane_tolerance / surface.unit;
  PatchSet before = std::exchange(partition.patches, std::move(joined.patches));
  const PatchSet& now = partition.patches;
  std::vector<double> areas(now.count(), 0);
  for (std::size_t p = 0; p < before.count(); ++p)
    areas[now.of_face[before.faces_of(PatchId(p))[0]].value] +=
        partition.summaries.patches[p].area / surface.unit / surface.unit;
  for (PatchId& p : partition.with_thin_faces) p = now.of_face[before.faces_of(p)[0]];
  for (std::size_t p = 0; p < now.count(); ++p)
    if (joined.of(PatchId(p)) != nullptr) partition.with_thin_faces.push_back(PatchId(p));
  partition.loops = boundary_loops(surface, adjacency, now, control);
  partition.essential = essential_vertices(surface, adjacency, partition.loops, rungs.is_forced,
                                           prepared.pinched(control), tolerance, control);
  partition.summaries =
      summarise_patches(surface, adjacency, areas, now, partition.loops, partition.essential, rungs, control);
  return before;
}

std::vector<std::uint8_t> find_simple_patches(const Partition& partition, const PatchMeshes& meshes) {
  std::vector<std::uint8_t> is_simple(partition.patches.count(), 0);
  if (meshes.size() != 0)
    for (PatchId p(0); p.value < is_simple.size(); ++p.value)
      is_simple[p.value] = meshes[p].reason == PatchReason::kNone;
  for (const PatchId p : partition.with_thin_faces) is_simple[p.value] = 0;
  return is_simple;
}

std::vector<FailedPatch> find_failed_patches(const PatchMeshes& meshes) {
  std::vector<FailedPatch> failed;
  for (std::size_t p = 0; p < meshes.size(); ++p)
    if (meshes[PatchId(p)].reason != PatchReason::kNone) failed.push_back({PatchId(p), meshes[PatchId(p)].reason});
  return failed;
}

}  // namespace remesh
