/// Checks the faces that were made of the input's polygons before remeshing. The other tests take the mended surface as
/// the input, and mending may be wrong.
#pragma once

#include <cstdint>

#include "core/base/run_control.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// The largest number of pairs of edges that are compared in one check of a mesh. Each pair takes up to about 25
/// nanoseconds.
inline constexpr std::uint64_t kMaxEdgePairs = std::uint64_t{1} << 24;

/// Measures each polygon of more than three corners by its outline in the file, and compares it with the faces of the
/// surface that were made of it. Together these faces must have the polygon's area vector. If the polygon is flat once
/// its spikes are cut off, the faces must also cover no more than its area; otherwise some of them overlap. Both
/// comparisons permit the changes that the tolerances can cause along the outline. Which triangles are right is certain
/// only if the outline is clearly simple in its plane once its spikes are cut off. An outline that crosses or touches
/// itself, for example along a bridge to a hole, is not tested.
///
/// To find out that an outline is simple, pairs of its edges are compared: those that overlap along the axis of space
/// along which the fewest pairs overlap. A mesh has a budget of such pairs. Polygons whose faces do not cover exactly
/// their area use this budget in the order of the file. A polygon that needs more than the rest of the budget is not
/// tested.
/// Input:   `claim` - a claim without an input passes without a test. Reports kPolygon.
/// Holds:   the faults depend neither on the number of threads nor on timing.
/// Errors:  kCancelled, kTimeout - stopped through `control`.
/// Cost:    O(corners of polygons), in parallel; for polygons in doubt, O(n log n) and at most `max_pairs`
///          comparisons.
void check_polygons(const Claim& claim, const NumberedClaim& numbered, FoundFaults& faults, RunControl& control,
                    std::uint64_t max_pairs = kMaxEdgePairs);

}  // namespace remesh::verification
