/// Cracks: open edges whose partners run beside them, further off than rounding explains. They are told, not closed.
#pragma once

#include <string>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Finds the pairs of open edges that are the nearest ones to each other and look like the two sides of a crack: they
/// run in opposite directions, their ends lie further apart than the tolerance, and no further than a tenth of either
/// edge and of how far either face reaches from it. Two edges of one face are none.
/// Input:   the tolerance in local units.
/// Output:  how far the ends of each pair are apart, the larger of both distances, ascending, in local units. None
///          where so many open edges lie beside each other that all pairs are too many.
/// Cost:    O(b log b) in open edges.
std::vector<double> crack_widths(const Surface& surface, const Adjacency& edges, double tolerance, RunControl& control);

/// Says of cracks how wide they are, and which `weld_tolerance` closes how many edges. That is not guessed: the input
/// is welded with it and its open edges are counted.
/// Input:   the mesh as read and the options that it was prepared with; the widths, ascending, in model units.
/// Output:  the text; empty without a crack. A tolerance is named only if it leaves fewer open edges than there were,
///          makes no edge of three or more faces, and takes no edge of a face away.
/// Cost:    O(n log n) where there is a crack.
std::string describe_cracks(const std::vector<double>& widths, const PolygonMesh& input, const Options& options,
                            RunControl& control);

}  // namespace remesh
