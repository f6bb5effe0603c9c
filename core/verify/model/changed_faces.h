/// Finds the output faces that may meet other faces where the input's faces do not meet.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/claim/claim.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Finds the output faces that are no triangles of the input, and the faces near these. Two triangles of the input meet
/// in the output where they meet in the input, so a new intersection has one of the changed faces.
/// Output: ascending numbers: the changed faces, and the faces whose boxes meet the box of a changed face.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
std::vector<std::uint32_t> faces_near_changes(const Claim& claim, const NumberedClaim& numbered,
                                              const EdgeTable& input_edges, RunControl& control);

}  // namespace remesh::verification
