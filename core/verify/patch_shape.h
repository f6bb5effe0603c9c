/// One patch by itself: is its output the same piece of surface as its input?
///
/// Why this proves the distance, both ways, once the boundary is right (boundary.h):
///  - In the patch's plane every output triangle is positively oriented. So the number of triangles over a point is the
///    winding number of the output's boundary around it: no fold, no overlap that the boundary does not force.
///  - Every input face is, too, but for slivers lower than twice the tolerance. So the same holds for the input, up to
///    points that close to a sliver's longest side.
///  - Input and output boundary differ by chains within the tolerance of their chords. A point further than that from
///    the boundary has the same winding number for both: covered by the input exactly where covered by the output.
///  - What lies over each other differs in height only. All vertices of the input lie within [A, B] over the plane,
///    those of the output, new ones too, within [a, b]; so no input point is further from the output than
///    max(B - a, b - A), nor the other way round. Where this bound is not within the tolerance, the height of each
///    input vertex over the output below it is measured instead, and that of each new vertex over the input, unless it
///    is within the tolerance of both A and B; between vertices the bound stands.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/boundary.h"
#include "core/verify/edge_table.h"
#include "core/verify/model.h"
#include "core/verify/verification_faults.h"

namespace remesh::verification {

/// What the patches tell about the whole, summed in patch order.
struct ShapeSums {
  double deviation = 0;      ///< largest distance between input and output
  double volume_change = 0;  ///< of the output against the input, meaningful for closed surfaces
  double volume_bound = 0;   ///< what deviations and rounding explain of it
};

/// Reports kNoFaces, kDeviation, kFacingAway, kArea, kZeroArea, kInverted, kFrame, kPlaneCoordinates.
/// A triangle that the input has too, in the same patch, is not held against the plane: it is what it was.
/// Output: `is_positive`, one per output face: its plane coordinates are on the grid and turn counter-clockwise.
/// Cost:   O(n), where distances must be measured O(n log n).
ShapeSums check_shapes(const Model& model, const EdgeTable& input_edges, const Seams& seams, const Boundary& boundary,
                       std::vector<std::uint8_t>& is_positive, Findings& findings, RunControl& control);

}  // namespace remesh::verification
