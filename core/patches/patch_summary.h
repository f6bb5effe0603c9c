/// What the report says of each patch.
#pragma once

#include <vector>

#include "core/geometry/patch_reason.h"
#include "core/geometry/patch_set.h"
#include "core/patches/boundary_loops.h"
#include "core/patches/essential_vertices.h"
#include "core/patches/ladder.h"

namespace remesh {

enum class PatchStatus { kRemeshed, kReduced, kKept };
/// The stable name.
std::string_view status_name(PatchStatus status);

struct PatchSummary {
  Vec3 normal;        ///< unit
  double offset = 0;  ///< normal . x = offset on the plane
  double area = 0;
  std::uint64_t input_faces = 0;
  std::uint64_t output_faces = 0;
  std::uint32_t loops = 0;
  std::uint32_t essential_vertices = 0;
  PatchStatus status = PatchStatus::kRemeshed;
  PatchReason reason = PatchReason::kNone;
  double deviation = 0;  ///< largest distance of an input vertex of the patch to its plane
};

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
