/// Checks the faces that mending made to close holes. The other tests treat these faces as a part of the input.
#pragma once

#include "core/base/run_control.h"
#include "core/verify/claim/claim.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Tests each face that closes a hole (Surface::caps):
/// - It lies in a plane, within the plane tolerance.
/// - At each of its edges is exactly one other face, which runs along the edge in the opposite direction and closes no
///   hole. So the face is bounded exactly by edges that were open without it. An edge may also belong to this face
///   alone, once in each direction: it is a bridge to an inner rim.
/// - It meets other faces, and itself, only in shared vertices and edges. This is tested exactly, by a search with the
///   usual bound on its work.
/// - The input face that is claimed to be its source is also the source of a face at its rim.
/// Input:   `edges` are those of the surface. A claim without an input passes without a test, because its surface was
///          not made by mending alone. Reports kCap.
/// Holds:   the faults do not depend on the number of threads.
/// Errors:  kCancelled, kTimeout - stopped through `control`.
/// Cost:    nothing without such faces; with them, that of a search for intersections with them.
void check_caps(const Claim& claim, const NumberedClaim& numbered, const EdgeTable& edges, FoundFaults& faults,
                RunControl& control);

}  // namespace remesh::verification
