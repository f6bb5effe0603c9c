/// Forces loop edges into a triangulation.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/triangulation/triangulation_2d.h"
#include "core/triangulation/triangulation_outcome.h"

namespace remesh {

using Segment = std::array<std::uint32_t, 2>;

/// Makes every segment an edge, constrains it, and restores the constrained Delaunay property.
/// Input:  `mesh` is a Delaunay triangulation of `points`. A segment is a pair of point indices, in either direction.
///         Segments may be repeated.
/// Output: kDone, or kCrossingConstraints. In the second case the triangulation is valid but lacks some segments.
/// Holds:  The result does not depend on the order of the segments.
/// Cost:   In practice it is near-linear in the number of edges that the segments cross.
/// Source: S. W. Sloan, A fast algorithm for generating constrained Delaunay triangulations, 1993.
TriangulationOutcome constraint_recovery(std::span<const Vec2> points, std::span<const Segment> segments,
                                         Triangulation2d& mesh, RunControl& control);

}  // namespace remesh
