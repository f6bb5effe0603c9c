/// Refines all patches together until every triangle meets the goals or has a reason why it cannot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patches/triangulated_patches.h"
#include "core/refinement/goals.h"
#include "core/refinement/patch_thinner.h"
#include "core/refinement/patches_aside.h"
#include "core/refinement/prediction.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"
#include "core/refinement/unrefined_reason.h"

namespace remesh {

/// The result of a refinement.
struct Refinement {
  std::vector<Vec3> new_positions;  ///< positions of the vertices from surface.vertex_count() on
  std::size_t first_inner = 0;      ///< new vertices from here on are inside patches
  /// One entry per triangle, patch after patch: the reason why it misses a goal. For triangles that meet the goals it
  /// may have any value.
  std::vector<UnrefinedReason> reason;
  /// One entry per triangle: not 0 if the triangle is larger, or may be larger, than gaps or short edges allow
  /// (size_misses.h). It is empty if all are 0.
  std::vector<std::uint8_t> misses_sizes;
  std::uint32_t rounds = 0;
  PatchesAside before;  ///< the patches that have changed, as they were before
};

/// The input of a refinement. It refers to these objects.
struct RefinementInput {
  const Surface& surface;
  /// One entry per patch. Frozen patches get no points, neither inside nor on their boundaries.
  const IdVector<PatchId, std::uint8_t>& is_frozen;
  const Goals& goals;  ///< `max_faces` is the budget
  const SizeField& sizes;
  const Prediction& prediction;  ///< used for the progress, and for the first division of a budget
  /// Refinement ends as soon as it is clear that the number of triangles will at some time exceed this.
  std::uint64_t max_made;
  /// How patches are thinned out if the budget ends refinement before the goals are met.
  Thinning thinning_in_budget = Thinning::kFull;
};

/// Refines in rounds. In a round, every patch that has work is refined alone, in parallel with the others. Between
/// rounds, the cuts that patches made in their boundaries go to all other patches there. The rounds end when no patch
/// has any work. Thinning out comes last, so there may be far more triangles between rounds than in the end; where
/// sizes vary, there may be three times as many. Therefore a budget may change the result even if the result does not
/// spend it, and refinement should first be tried without one.
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
