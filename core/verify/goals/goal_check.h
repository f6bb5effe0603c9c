/// Checks refinement's goals. The claim's list must contain exactly the faces that miss the goals, and the reason that
/// the list gives for each face must apply.
#pragma once

#include "core/base/run_control.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/goals/varying_sizes.h"
#include "core/verify/model/boundary_graph.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Reports kUnlisted, kListedInVain, kCertificate, kShortEdge, kLockedBoundary, kTooManyFaces.
///
/// Everything is measured on the output's doubles. Two programs that compute the same measure differ in the last
/// digits. So a face within 1e-9 of a bound may be listed or not. The same holds within VaryingSizes::kClearly of a
/// bound that varies from place to place.
/// Input:  `edges` - the output's edges; `seams` - those of them that bound patches; `sizes` - the bounds that vary
///         from place to place, null if the goals have none.
/// Cost:   O(n log n).
void check_goals(const RefinementClaim& refinement, const NumberedClaim& numbered, const EdgeTable& edges,
                 const BoundaryGraph& seams, const VaryingSizes* sizes, FoundFaults& faults, RunControl& control);

/// The relation of a number to a bound that it should not cross. Within 1e-9 of the bound it is kOnTheEdge.
enum class Standing { kMeets, kOnTheEdge, kMisses };

/// Compares a triangle with the bounds on angles, edges and areas.
/// Input: model units; the area must not overflow.
Standing standing_of(const Goals& goals, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh::verification
