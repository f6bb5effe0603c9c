/// Finds refined triangles that are larger than gaps or short edges ask for.
#pragma once

#include <cstdint>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_mesh.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/rounds/rounds.h"
#include "core/refinement/sizes/gap_search.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// The bounds on sizes that differ from place to place.
struct VaryingBounds {
  const Goals& goals;
  double plane_tolerance;  ///< model units
  /// The sizes at which refinement aimed. They have a floor, and are interpolated between the places where gaps were
  /// measured.
  const SizeField& sizes;
  /// The gaps themselves, with goals.proximity; null otherwise.
  const GapSearch* gaps = nullptr;
  /// The sizes that short edges require, without a floor, if goals.gradation is set without proximity; null otherwise.
  const SizeField* graded = nullptr;
};

/// Compares each triangle with the sizes that its own places require, not with the sizes at which refinement aimed.
///
/// With proximity a place requires the size (gap + plane_tolerance) / proximity. A triangle is tested at its centroid
/// and in the middles of its three edges, each as a place of its patch. It misses its bound if one of its edges is
/// longer than Goals::kSizeSlack times the following sum: the size that one of these places requires, plus the slope
/// (gradation - 1) times the distance from there to the middle of the edge.
///
/// With gradation alone, a segment between vertices that stay requires its own length, and sizes grow from it with the
/// distance. A triangle misses its bound if one of its edges is longer than Goals::kSizeSlack times the size in its
/// middle.
///
/// Input:  The refined patches. `is_frozen` has one entry per patch; refinement does not change frozen ones.
/// Output: `refinement.misses_sizes`, and for each of these triangles the reason in `refinement.reason`. If the
///         triangle is longer than the sizes that were aimed at, the reason is the one that refinement had. Otherwise
///         these sizes were too large there. That is because of the floor (`size_floor`, or `min_edge_length` where
///         that is the floor), or because gaps are looked for at a limited number of places (`effort`).
///         The searches for gaps have a bound on their work. A triangle that was not tested because of that bound has
///         kMayMissSizes in `refinement.misses_sizes`. A sharp corner of the input is then no longer its reason.
/// Holds:  The result is the same for any number of threads.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   Two or three searches for gaps for each triangle, in parallel. No search goes farther than the length of the
///         triangle's edges times proximity, and all together take no more steps than kWorkOfMisses.
void record_oversized_triangles(const Surface& surface, const PatchMeshes& meshes,
                                const IdVector<PatchId, std::uint8_t>& is_frozen, const VaryingBounds& bounds,
                                Refinement& refinement, RunControl& control);

}  // namespace remesh
