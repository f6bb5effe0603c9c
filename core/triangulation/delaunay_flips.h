/// Makes a triangulation Delaunay, or constrained Delaunay if it has constrained edges, by flipping edges.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// Flips edges until every edge that is not constrained is locally Delaunay.
/// Output: The unique constrained Delaunay triangulation of the points. It is unique because in_circle_perturbed breaks
///         the ties of cocircular points.
/// Cost:   Near-linear for the triangulation that the sweep makes of scattered points. A stack holds only the edges
///         that may have changed.
/// Source: C. Lawson, 1977; J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 6;
///         rules.md, Exact flips.
void delaunay_flips(std::span<const Vec2> points, Triangulation2d& mesh, RunControl& control);

/// Flips edges in the same way, but begins with the half-edges in `stack` alone. The stack is empty afterwards.
void delaunay_flips(std::span<const Vec2> points, Triangulation2d& mesh, std::vector<std::uint32_t>& stack,
                    RunControl& control);

}  // namespace remesh
