/// The constrained Delaunay triangulation of one patch: sweep, flips, recovery and carving together.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/outcome.h"
#include "core/geometry/triangulation_2d.h"
#include "core/triangulation/constraint_recovery.h"

namespace remesh {

struct PatchTriangulation {
  Outcome outcome = Outcome::kDone;
  Triangulation2d mesh;  ///< over the points' indices; empty unless kDone
};

/// Triangulates the inside of loops.
/// Input:  pairwise different points in lexicographic order; directed loop edges with the inside on their left; an edge
///         given in both directions is a slit.
/// Output: the one constrained Delaunay triangulation, whatever the order of the edges.
/// Cost:   O(n log n): above a few hundred points divide and conquer takes the place of the sweep and the first flips.
PatchTriangulation triangulate_patch(std::span<const Vec2> points, std::span<const Segment> loop_edges,
                                     RunControl& control);

/// The Delaunay triangulation of points alone, by whichever of the two ways suits their number.
Triangulation2d triangulate_points(std::span<const Vec2> points, RunControl& control);

}  // namespace remesh
