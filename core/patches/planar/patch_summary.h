/// The part of the report on each patch.
#pragma once

#include <vector>

#include "core/mesh/face_geometry.h"
#include "core/patch_types/patch_reason.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/patches/planar/face_rungs.h"

namespace remesh {

enum class PatchStatus { kRemeshed, kReduced, kKept };
/// The stable name of a status.
std::string_view status_name(PatchStatus status);

struct PatchSummary {
  Vec3 normal;        ///< unit length
  double offset = 0;  ///< normal . x = offset for points x of the plane
  double area = 0;
  double deviation = 0;  ///< largest distance of an input vertex of the patch from its plane
  double bound = 0;      ///< proven distance between input and output of the patch, both ways, in model units
  std::uint32_t input_faces = 0;
  std::uint32_t output_faces = 0;
  std::uint32_t loops = 0;
  std::uint32_t essential_vertices = 0;
  PatchStatus status = PatchStatus::kRemeshed;
  PatchReason reason = PatchReason::kNone;
};

struct PatchSummaries {
  std::vector<PatchSummary> patches;
  /// The number of triangles that the patches' loops and points require (Euler). If no patch fails, the result has this
  /// number.
  std::uint64_t triangles = 0;
  /// The sum over all patches of their area times the distance between the two planes, one below and one above the
  /// patch's own, between which the patch lies. In cubed model units.
  double volume_bound = 0;
};

/// Computes the areas of the patches, which are the sums of their faces' areas.
/// Output:  one area per patch, in squared local units.
/// Holds:   the result has the same bits for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(faces).
std::vector<double> patch_areas(const PatchSet& patches, const FaceGeometries& geometry, RunControl& control);

/// Summarises the patches. `areas` come from patch_areas. `output_faces` is set to the number of triangles that Euler's
/// formula gives.
PatchSummaries summarise_patches(const Surface& surface, const Adjacency& adjacency, const std::vector<double>& areas,
                                 const PatchSet& patches, const BoundaryLoops& loops,
                                 const EssentialVertices& essential, const SurfaceRungs& rungs, RunControl& control);

}  // namespace remesh
