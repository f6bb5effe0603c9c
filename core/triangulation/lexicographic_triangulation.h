/// Triangulates points by a sweep in lexicographic order.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// Triangulates the convex hull of the points. Every new point is joined to all hull edges that it sees.
/// Input:  The points are pairwise different and in lexicographic order (x, then y).
/// Output: Counter-clockwise triangles over the points' indices. It is empty if all points are on one line.
/// Holds:  Every point is a corner, and the hull is convex. There are 2n - 2 - (points on the hull) triangles.
/// Cost: O(n). The hull is a ring of linked points, and each step costs only what it changes of the hull.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, sections 5.4 to 5.6; rules.md, Sweep.
Triangulation2d lexicographic_triangulation(std::span<const Vec2> points, RunControl& control);

}  // namespace remesh
