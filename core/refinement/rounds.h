/// Refines all patches together until every triangle meets the goals, or says why it cannot.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/surface.h"
#include "core/refinement/goals.h"
#include "core/refinement/prediction.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"
#include "core/refinement/unrefined_reason.h"

namespace remesh {

/// A triangle that may not meet the goals knows why; the others have any value.
struct Refinement {
  std::vector<Vec3> new_positions;      ///< of the vertices from surface.vertex_count() on
  std::size_t first_inner = 0;          ///< from here on they are inside patches
  std::vector<UnrefinedReason> reason;  ///< one per triangle, patch after patch
  /// One per triangle: is it larger than gaps or short edges ask for (size_misses.h)? Empty: none is.
  std::vector<std::uint8_t> misses_sizes;
  std::uint32_t rounds = 0;
};

/// Rounds: every patch that has something to do refines alone, in parallel; between rounds the cuts that patches made
/// in their boundaries go to all patches there. Until no patch has anything to do.
/// Between rounds there may be far more triangles than in the end, where sizes vary thrice as many: thinning out comes
/// last. So a budget that is not spent may still have changed the result, and first of all it should be tried without.
/// Input:   triangulated patches; `is_frozen`, one per patch: nothing is put into these, nor on their boundaries; the
///          segments of these patches, with their cuts planned; what is predicted, for the progress and for sharing out
///          a budget at first; `most_made`: when it is clear that there will ever be more triangles, it ends.
/// Output:  the patches with more vertices: those from surface.vertex_count() on are in `new_positions`. Nothing, and
///          the patches as they were, where there would be more than `most_made`.
/// Holds:   an edge between patches has the same vertices for all of them; the same result for any number of threads.
/// Cost:    O(n log n) in the result's triangles, in practice.
/// Source:  rules.md, Rounds; rules.md, Budget; for what patches do in their turns the rules 13 to 22 there.
std::optional<Refinement> refine(const Surface& surface, const PatchSet& patches,
                                 const std::vector<std::uint8_t>& is_frozen, const Goals& goals, const SizeField& sizes,
                                 SegmentTable segments, const Prediction& prediction, std::vector<PatchMesh>& meshes,
                                 std::uint64_t most_made, RunControl& control);

/// The chord rule, where neither flips nor refinement help: each chord of the patches as they are now gets a point.
/// Input:   the patches and what refinement says of them, or nothing yet (then `is_frozen` may be empty, and `why` is
///          without effect); `why`: why refinement itself has not split these chords.
/// Output:  both with the new vertices. A new triangle that misses a goal is `boundary_locked` if its patch is frozen;
///          else it misses it for the reason `why`.
void split_chords(const Surface& surface, const PatchSet& patches, std::vector<PatchMesh>& meshes,
                  Refinement& refinement, const std::vector<std::uint8_t>& is_frozen, UnrefinedReason why,
                  RunControl& control);

}  // namespace remesh
