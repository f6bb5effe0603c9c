/// Forces loop edges into a triangulation.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/outcome.h"
#include "core/geometry/triangulation_2d.h"

namespace remesh {

using Segment = std::array<std::uint32_t, 2>;

/// Makes every segment an edge, constrains it, and restores the constrained Delaunay property.
/// Input:   a Delaunay triangulation; segments as pairs of point indices, in either direction, repeats allowed.
/// Output:  kDone, or kCrossingConstraints: the triangulation is then valid but lacks segments.
/// Holds:   the result does not depend on the order of the segments.
/// Cost:    near-linear in the edges that the segments cross, in practice.
/// Source:  S. W. Sloan, A fast algorithm for generating constrained Delaunay triangulations, 1993.
Outcome constraint_recovery(std::span<const Vec2> points, std::span<const Segment> segments, Triangulation2d& mesh,
                            RunControl& control);

}  // namespace remesh
