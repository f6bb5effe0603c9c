/// Removes details from a surface after it has been divided into patches.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_marks.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/run/candidate.h"
#include "core/output/run/replaced.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/meshing/triangulated_patches.h"

namespace remesh {

/// The details that count. Lengths are in model units.
struct DetailLimits {
  double size = 0;  ///< 0: nothing is removed
  /// Corners may be off their planes by half of this. It is at least the plane tolerance, and all bounds together are
  /// within the size.
  double plane_tolerance = 0;
  bool is_size_given = false;  ///< false: the size is the plane tolerance
};

DetailLimits detail_limits(const Options& options, double plane_tolerance);

/// Details are removed so often at most. Each time may show smaller ones.
inline constexpr std::size_t kMaxDetailPasses = 3;

/// Counts the details that were removed, in all passes together.
struct RemovedDetails {
  std::uint64_t joined_edges = 0, closed_slivers = 0, removed_tiny_components = 0, closed_narrow_notches = 0;
  Diagnostic faces;  ///< the input faces under what was removed
  bool is_effort_spent = false;
};

/// Returns whether the triangles of the patches have any details, or the surface has open edges, between which there
/// may be narrow notches.
/// Cost: O(triangles).
bool are_details_there(const DetailLimits& limits, const TriangulatedPatches& triangulated, const Surface& surface,
                       const Adjacency& adjacency, RunControl& control);

/// Holds the surface as it is, and how it became so.
struct DetailContext {
  const PolygonMesh* input;  ///< as it was read; null if a stage has replaced the surface that was made of it
  const Surface& surface;
  const PatchSet& patches;
  InputIntersections intersections;
  double plane_tolerance;  ///< model units
  double weld_tolerance;   ///< model units
  const FaceMarks& kept;   ///< the corners of such faces stay
  double spent_distance;   ///< what stages before have spent of the size, in model units
};

/// Makes the triangles of a surface's patches, without the details among them, another surface. So details are looked
/// for where they matter: between vertices that would stay. First it is proven that the triangles are the surface.
/// Input:   a candidate that has been triangulated without failures, and no more. If nothing is done, its
///          triangles stay, unless edges of them were changed for the sake of chords.
/// Output:  nothing, if nothing was removed or proven. Otherwise the new surface. Its faces have the sources of the
///          faces under them, and the first face of each patch covers all input faces that the patch covered. What was
///          removed is added to `removed`.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    that of remove_details, of a check and of a search for intersections.
std::optional<Replaced> without_details(const DetailContext& context, Candidate& candidate, const DetailLimits& limits,
                                        RemovedDetails& removed, Stopwatch& watch, RunControl& control);

/// Tells what was removed. Something was.
/// Input: `bound` is how far the surface moved, in model units.
Diagnostic removal(const RemovedDetails& removed, double size, double bound);

/// If a size was given, tells which edges of the result are shorter than a third of it, and which separate parts are no
/// larger than it.
void report_details_left(const DetailLimits& limits, const Candidate& result, const PatchSet& patches,
                         const Surface& surface, std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
