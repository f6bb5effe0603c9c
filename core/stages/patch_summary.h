/// What the report says of each patch.
#pragma once

#include <vector>

#include "core/report.h"
#include "core/stages/boundary_loops.h"
#include "core/stages/essential_vertices.h"
#include "core/stages/ladder.h"
#include "core/stages/patches.h"

namespace remesh {

struct PatchSummaries {
  std::vector<PatchSummary> patches;
  std::uint64_t triangles = 0;  ///< that the patches' loops and points ask for (Euler); what they get, if none fails
  /// Model units cubed, over all patches: their area times the distance between the planes, one below and one above the
  /// patch's own, between which it lies.
  double volume_bound = 0;
};

/// The areas of the patches: the sums of their faces'.
/// Output:  one for each patch, in squares of the local unit.
/// Holds:   the same bits for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(faces).
std::vector<double> patch_areas(const PatchSet& patches, const FaceGeometries& geometry, RunControl& control);

/// Summarises the patches as they stand; `areas` as above; `output_faces` is what Euler's formula gives.
PatchSummaries summarise_patches(const Surface& surface, const Adjacency& adjacency, const std::vector<double>& areas,
                                 const PatchSet& patches, const BoundaryLoops& loops,
                                 const EssentialVertices& essential, const Ladder& ladder, RunControl& control);

}  // namespace remesh
