/// Makes a triangulation (constrained) Delaunay by flipping edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangulation_2d.h"

namespace remesh {

/// Flips edges until every edge that is not constrained is locally Delaunay.
/// Output:  the one constrained Delaunay triangulation of the points: ties of cocircular points are broken by
///          in_circle_perturbed.
/// Cost:    near-linear for what the sweep makes of scattered points; a stack holds only edges that may have changed.
/// Source:  C. Lawson, 1977; J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 6;
///          rules.md, Exact flips.
void delaunay_flips(std::span<const Vec2> points, Triangulation2d& mesh, RunControl& control);

/// The same, begun from the half-edges in `stack` alone; it is empty afterwards.
void delaunay_flips(std::span<const Vec2> points, Triangulation2d& mesh, std::vector<std::uint32_t>& stack,
                    RunControl& control);

}  // namespace remesh
