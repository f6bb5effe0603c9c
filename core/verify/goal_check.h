/// Refinement's goals: are the faces that miss them the listed ones, and what is listed for an input angle at one?
#pragma once

#include "core/base/run_control.h"
#include "core/verify/boundary_graph.h"
#include "core/verify/edge_table.h"
#include "core/verify/model.h"
#include "core/verify/varying_sizes.h"
#include "core/verify/verification_faults.h"
#include "core/verify/verify.h"

namespace remesh::verification {

/// Reports kUnlisted, kListedInVain, kCertificate, kShortEdge, kLockedBoundary, kTooManyFaces.
/// Measures are of the output's doubles. Two that compute them differ in the last places; what is within 1e-9 of a
/// bound may be listed or not, and what is within VaryingSizes::kClearly of a bound that differs from place to place.
/// Input:  the output's edges, and those of them that bound patches; the bounds that differ from place to place, null
///         if the goals have none.
/// Cost:   O(n log n).
void check_goals(const RefinementClaim& refinement, const Model& model, const EdgeTable& edges,
                 const BoundaryGraph& seams, const VaryingSizes* sizes, Findings& findings, RunControl& control);

/// How a number stands to a bound that it is not to cross; within 1e-9 of the bound it is on the edge.
enum class Standing { kMeets, kOnTheEdge, kMisses };

/// How a triangle stands to the bounds on angles, edges and areas. Model units; the area must not overflow.
Standing standing_of(const Goals& goals, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh::verification
