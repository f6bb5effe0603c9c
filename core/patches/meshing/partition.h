/// Divides a prepared surface into patches, and computes all that later stages need to know of them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mending/preparation.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patch_types/patch_reason.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/coplanar_regions.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/patches/planar/face_rungs.h"
#include "core/patches/planar/patch_summary.h"

namespace remesh {

/// A patch whose triangulation or verification failed, and the reason.
struct FailedPatch {
  PatchId patch;
  PatchReason reason;
};

/// A surface divided into patches, with their boundary loops and the vertices on these that stay.
struct Partition {
  PatchSet patches;
  BoundaryLoops loops;
  EssentialVertices essential;
  PatchSummaries summaries;
  std::vector<PatchId> with_thin_faces;  ///< patches with faces that may be turned over; listed once per such face
};

/// Splits a surface into patches, as in sections 2 to 4 of J. Vermaak, The Surface Remeshing Module in ChiTech, 2018.
/// Input:   `plane_tolerance` is in model units. `regions` are those of an earlier partition, or empty. Faces with a
///          rung, which are to be divided more finely because an attempt has failed, have no region and get a new one.
/// Output:  the partition, and the `regions` of all faces.
/// Holds:   the result is the same for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
Partition make_partition(Prepared& prepared, double plane_tolerance, const Options& options, const SurfaceRungs& rungs,
                         Regions& regions, Stopwatch& watch, RunControl& control);

/// Takes patches that were joined from those of a partition in their place, and finds their boundaries.
/// Output:  the patches before. Curved patches count as patches with thin faces: they may cover a plane twice.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
PatchSet take_joined_patches(Partition& partition, Prepared& prepared, CurvedPatches& joined, double plane_tolerance,
                             const SurfaceRungs& rungs, RunControl& control);

/// Returns which patches cover nothing twice in their plane: their loops do not cross, and none of their faces is so
/// thin that it may be turned over.
/// Input:   one mesh per patch, or none if there are none yet. Then no patch counts as one that covers nothing twice.
std::vector<std::uint8_t> find_simple_patches(const Partition& partition, const PatchMeshes& meshes);

/// Returns the patches that could not be triangulated, and the reasons.
std::vector<FailedPatch> find_failed_patches(const PatchMeshes& meshes);

}  // namespace remesh
