/// Cracks: open edges whose partners run beside them, further away than rounding explains. They are reported, but not
/// closed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

struct Cracks {
  std::uint64_t edges = 0;     ///< open edges that run beside another one
  std::vector<double> widths;  ///< in model units, ascending; one width for two edges that are each other's partners
};

/// Finds the open edges that look like the sides of a crack. There are two kinds:
/// - Two edges are the nearest ones to each other. The width is the larger of both distances between their ends.
/// - An edge has no such partner, but runs along a longer or shorter one. This happens if the sides are subdivided
///   differently. The width is the largest distance between the two where they are beside each other.
/// The width must be more than rounding explains. It must be at most a tenth of either edge's length, and of how far
/// either face reaches from its edge. Two edges of one face are no crack. The two edges may run the same way, because a
/// face may have to be turned over.
/// Input:   `rounding` is how far rounding moves points, in model units.
/// Output:  no cracks if so many open edges lie beside each other that there are too many pairs to test.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(b log b) for b open edges.
Cracks find_cracks(const Surface& surface, const Adjacency& edges, double rounding, RunControl& control);

/// The tolerances with which the mesh was prepared, in model units.
struct CrackRules {
  double rounding = 0;         ///< seams up to this width are closed
  double plane_tolerance = 0;  ///< edges are split at vertices up to this far away
};

/// Describes how wide cracks are, and how many edges a certain `weld_tolerance` would close. The number is no estimate:
/// the input is welded with that tolerance, edges are split and seams are closed, and the remaining open edges are
/// counted.
/// Input:   the mesh as read, and the options with which it was prepared.
/// Output:  the text; empty if there is no crack. A tolerance is named only if it leaves fewer open edges than there
///          were, makes no further edges with three or more faces, and makes no further edge of a face vanish.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) if there is a crack.
Advice describe_cracks(const Cracks& cracks, const PolygonMesh& input, const Options& options, const CrackRules& rules,
                       RunControl& control);

}  // namespace remesh
