/// Removes the triangles that lie outside the loops or in their holes.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/triangulation/constraint_recovery.h"
#include "core/triangulation/triangulation_2d.h"
#include "core/triangulation/triangulation_outcome.h"

namespace remesh {

/// Keeps only the triangles inside the loops.
/// Input:  `mesh` is a triangulation in which all `loop_edges` are constrained. Each loop edge is directed and has the
///         inside on its left. An edge that is given in both directions has the inside on both sides (a slit).
/// Output: kDone, or kInconsistentLoops if a region is inside by one edge and outside by another. Then nothing is
///         removed.
/// Cost:   O(n).
/// Source: rules.md, Carving.
TriangulationOutcome carving(std::span<const Segment> loop_edges, Triangulation2d& mesh, RunControl& control);

}  // namespace remesh
