/// Removes what lies outside the loops and in their holes.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/geometry/outcome.h"
#include "core/geometry/triangulation_2d.h"
#include "core/triangulation/constraint_recovery.h"

namespace remesh {

/// Keeps the triangles inside the loops.
/// Input:   a triangulation in which all `loop_edges` are constrained; each is directed, with the inside on its left.
///          An edge given in both directions has the inside on both sides (a slit).
/// Output:  kDone; or kInconsistentLoops - a region is inside by one edge and outside by another; nothing is removed
///          then.
/// Cost:    O(n).
/// Source:  rules.md, Carving.
Outcome carving(std::span<const Segment> loop_edges, Triangulation2d& mesh, RunControl& control);

}  // namespace remesh
