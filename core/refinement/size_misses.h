/// Refined triangles that are larger than gaps or short edges ask for.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/mesh/surface.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goals.h"
#include "core/refinement/rounds.h"
#include "core/refinement/size_field.h"

namespace remesh {

/// The bounds that differ from place to place.
struct VaryingBounds {
  const Goals& goals;
  double plane_tolerance;  ///< model units
  /// The sizes that refinement aimed at. They have a floor, and between the places that were looked at they are
  /// interpolated.
  const SizeField& sizes;
  /// With goals.proximity: the gaps themselves. Null without.
  const GapSearch* gaps = nullptr;
  /// With goals.gradation alone: what short edges ask for, with no floor under it. Null with proximity.
  const SizeField* graded = nullptr;
  /// Patches that cross or touch each other in the input, the smaller one first: between these there is no gap.
  std::span<const std::pair<PatchId, PatchId>> crossing = {};
};

/// Measures each triangle by what its own places ask for, not by the sizes that refinement aimed at.
///
/// With proximity a place asks for the size (gap + plane_tolerance) / proximity. A triangle is looked at in its
/// centroid and in the middles of its three edges, each as a place of its patch. It misses its bound if one of its
/// edges is longer than Goals::kSizeSlack times what one of these places asks for and the slope (gradation - 1) times
/// the way from there to the middle of the edge.
///
/// With gradation alone, a segment between vertices that stay asks for its own length, and sizes grow from it with the
/// distance. A triangle misses its bound if one of its edges is longer than Goals::kSizeSlack times the size in its
/// middle.
///
/// Input:   the refined patches. `is_frozen`: those that refinement had to leave alone, one per patch.
/// Output:  `refinement.misses_sizes`; and in `refinement.reason`, for each of these triangles, why that is so. Where
///          it is longer than the sizes that were aimed at, it is the reason that refinement had. Else these sizes were
///          too large there: for the floor (`size_floor`, or `min_edge_length` where that is the floor), or since only
///          so many places are looked at (`effort`).
/// Holds:   the same for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    two or three looks for gaps for each triangle, none of them farther than its edges are long times
///          proximity; in parallel.
void note_size_misses(const Surface& surface, const std::vector<PatchMesh>& meshes,
                      const std::vector<std::uint8_t>& is_frozen, const VaryingBounds& bounds, Refinement& refinement,
                      RunControl& control);

}  // namespace remesh
