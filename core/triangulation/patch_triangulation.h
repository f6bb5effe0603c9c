/// Computes the constrained Delaunay triangulation of one patch by sweep, flips, recovery and carving.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/triangulation/constraint_recovery.h"
#include "core/triangulation/triangulation_2d.h"
#include "core/triangulation/triangulation_outcome.h"

namespace remesh {

struct PatchTriangulation {
  TriangulationOutcome outcome = TriangulationOutcome::kDone;
  Triangulation2d mesh;  ///< indexes the input points; empty unless the outcome is kDone
};

/// Triangulates the inside of the loops.
/// Input:  The points are pairwise different and in lexicographic order. Loop edges are directed and have the inside on
///         their left. An edge that is given in both directions is a slit.
/// Output: The unique constrained Delaunay triangulation, whatever the order of the edges.
/// Cost:   O(n log n). Above a few hundred points, divide and conquer takes the place of the sweep and of the first
///         flips.
PatchTriangulation triangulate_patch(std::span<const Vec2> points, std::span<const Segment> loop_edges,
                                     RunControl& control);

/// Computes the Delaunay triangulation of the points, without any constraint. It uses the sweep for few points and
/// divide and conquer for many.
Triangulation2d triangulate_points(std::span<const Vec2> points, RunControl& control);

}  // namespace remesh
