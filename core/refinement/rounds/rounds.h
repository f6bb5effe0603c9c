/// Refines all patches together until every triangle meets the goals or has a reason why it cannot.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/rounds/refinement.h"
#include "core/refinement/rounds/refinement_input.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {

/// Refines in rounds. In a round, every patch that has something to do is refined alone, in parallel with the others.
/// Between rounds, the cuts that patches made in their boundaries go to all other patches there. The rounds end when no
/// patch has anything to do. Thinning out comes last, so there may be far more triangles between rounds than in the
/// end; where sizes vary, there may be three times as many. Therefore even a budget that the result does not spend may
/// have changed the result, and refinement should first be tried without one.
/// Input:  Triangulated patches. `segments` are the segments of these patches, with their cuts planned.
/// Output: The patches with additional vertices. The vertices from surface.vertex_count() on have their places in
///         `new_positions`. If there would be more than `max_made` triangles, nothing is returned and the patches are
///         as they were.
/// Holds:  An edge between patches has the same vertices in all of them. The result is the same for any number of
///         threads.
/// Cost:   O(n log n) in the triangles of the result, in practice.
/// Source: rules.md, Rounds; rules.md, Budget; rules 13 to 22 there for what patches do in their turns.
std::optional<Refinement> refine(const RefinementInput& input, SegmentTable segments, TriangulatedPatches& triangulated,
                                 RunControl& control);

/// Applies the chord rule (chords.h) where neither flips nor refinement have helped: every chord that is left gets a
/// point.
/// Input:  `refinement` is the result of the refinement of these patches. Before any refinement, it is empty; then
///         `is_frozen` may be empty, and `why` has no effect. `why` is the reason why refinement itself has not split
///         these chords.
/// Output: The patches and `refinement`, with the new vertices. A new triangle that misses a goal has the reason
///         `boundary_locked` if its patch is frozen, and the reason `why` otherwise.
void split_chords(const Surface& surface, TriangulatedPatches& triangulated, Refinement& refinement,
                  const IdVector<PatchId, std::uint8_t>& is_frozen, UnrefinedReason why, RunControl& control);

}  // namespace remesh
