/// Cracks: open edges whose partners run beside them, further off than rounding explains. They are told, not closed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

struct Cracks {
  std::uint64_t edges = 0;     ///< open edges that run beside another one
  std::vector<double> widths;  ///< ascending, in model units; of two edges that are each other's partners, one
};

/// Finds the open edges that look like the sides of a crack. Either two are the nearest ones to each other, and the
/// width is the larger of both distances between their ends; or an edge has no such partner and runs along a longer or
/// shorter one, as where the sides are subdivided differently, and the width is how far it goes from it beside it.
/// The width is more than rounding explains, and no more than a tenth of either edge and of how far either face reaches
/// from it. Two edges of one face are none. They may run the same way: a face may have to be turned over.
/// Input:   how far rounding moves points, in model units.
/// Output:  none where so many open edges lie beside each other that all pairs are too many.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(b log b) in open edges.
Cracks find_cracks(const Surface& surface, const Adjacency& edges, double rounding, RunControl& control);

/// How the mesh was prepared, in model units.
struct CrackRules {
  double rounding = 0;         ///< seams up to this are closed
  double plane_tolerance = 0;  ///< edges are split at vertices within this
};

/// Says of cracks how wide they are, and which `weld_tolerance` closes how many edges. That is not guessed: the input
/// is welded with it, its edges are split and its seams closed as they would be, and its open edges are counted.
/// Input:   the mesh as read and the options that it was prepared with.
/// Output:  the text; empty without a crack. A tolerance is named only if it leaves fewer open edges than there were,
///          makes no edge of three or more faces, and takes no edge of a face away.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) where there is a crack.
std::string describe_cracks(const Cracks& cracks, const PolygonMesh& input, const Options& options,
                            const CrackRules& rules, RunControl& control);

}  // namespace remesh
