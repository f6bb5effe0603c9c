/// Triangulates points by a sweep in lexicographic order.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangulation_2d.h"

namespace remesh {

/// Triangulates the convex hull of points; every new point is joined to all hull edges that it sees.
/// Input:   pairwise different points in lexicographic order (x, then y).
/// Output:  counter-clockwise triangles over the points' indices; empty if all points are on one line.
/// Holds:   every point is a corner; the hull is convex; 2n - 2 - (points on the hull) triangles.
/// Cost:    O(n): each step costs what it changes of the hull, a ring of linked points.
/// Source:  J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, sections 5.4 to 5.6; rules.md, Sweep.
Triangulation2d lexicographic_triangulation(std::span<const Vec2> points, RunControl& control);

}  // namespace remesh
