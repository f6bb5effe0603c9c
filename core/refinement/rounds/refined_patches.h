/// Collects the patches at the end of a refinement, and gives their new vertices numbers and positions.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/patch_types/patch_mesh.h"
#include "core/refinement/refiner/patch_refiner.h"
#include "core/refinement/rounds/patch_backup.h"
#include "core/refinement/rounds/refinement.h"
#include "core/refinement/rounds/refinement_input.h"
#include "core/refinement/segments/segment_cuts.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {

/// The refiners of all patches. A patch without a refiner has not changed.
using PatchRefiners = IdVector<PatchId, std::unique_ptr<PatchRefiner>>;

/// Numbers the vertices inside a patch that have no id yet, from `first` on, and sets their positions.
/// Output: the number of these vertices.
std::size_t place_inner_vertices(const Surface& surface, const PatchChart& chart, PatchMesh& patch, std::size_t first,
                                 std::vector<Vec3>& new_positions);
/// Counts the vertices inside a patch that have no id yet.
std::size_t count_unplaced(const PatchMesh& patch);

/// Makes the patches from the present state of their refiners. New vertices on segments come first, segment after
/// segment, and then those inside patches, patch after patch.
/// Input:  If `are_refiners_kept` is false, each refiner is deleted when its patch is made.
/// Output: The patches that have a refiner, and `new_positions`, `first_inner` and `reason` of the result. A patch
///         without a refiner stays as it was, because it is frozen or has no work.
PatchBackup collect_refined(const RefinementInput& input, const SegmentTable& segments, const SegmentCuts& cuts,
                            const TriangulatedPatches& triangulated, PatchRefiners& refiners, bool are_refiners_kept,
                            Refinement& result, RunControl& control);

}  // namespace remesh
