/// Checks each patch by itself: its output must be the same piece of surface as its input.
///
/// This is why the check proves the distance in both directions, once the boundary is right (boundary.h):
///  - In the patch's plane every output triangle is positively oriented. So the number of triangles over a point is
///    the winding number of the output's boundary around it. There is no fold, and no overlap that the boundary does
///    not force.
/// - Every input face is positively oriented too, except slivers lower than twice the tolerance. So the same is true of
///   the input, except for points within that distance of a sliver's longest side.
///  - Input and output boundary differ by chains within the tolerance of their chords. A point further than that from
///    the boundary has the same winding number for both. So the input covers it exactly if the output covers it.
///  - Where both cover a point, they differ in height only. All vertices of the input lie within [A, B] over the
///    plane, and those of the output, including new ones, within [a, b]. So no input point is further from the output
///    than max(B - a, b - A), and no output point is further from the input. If this bound is not within the
///    tolerance, the height of each input vertex over the output below it is measured instead. The height of each new
///    vertex over the input is measured too, unless it is within the tolerance of both A and B. Between vertices the
///    bound applies.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/boundary/boundary.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"
#include "core/verify/patches/shape_sums.h"

namespace remesh::verification {

/// Reports kNoFaces, kDeviation, kFacingAway, kArea, kZeroArea, kInverted, kFrame, kPlaneCoordinates.
/// A triangle that the same patch has in the input is not compared with the plane, because it has not changed. For
/// curved patches, see curved_patch.h.
/// Output: `is_positive` - one per output face: its plane coordinates are on the grid and turn counter-clockwise. It is
///         0 for all faces of curved patches. `bounds` - one per patch: no point of its input is further from its
///         output, or the other way round.
/// Cost:   O(n); O(n log n) if distances must be measured.
ShapeSums check_shapes(const NumberedClaim& numbered, const EdgeTable& input_edges, const Seams& seams,
                       const Boundary& boundary, std::vector<std::uint8_t>& is_positive, std::vector<double>& bounds,
                       FoundFaults& faults, RunControl& control);

}  // namespace remesh::verification
