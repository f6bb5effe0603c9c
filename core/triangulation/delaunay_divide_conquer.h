/// The Delaunay triangulation of many points in guaranteed O(n log n). It is meant for points on which sweeping and
/// flipping is slow.
#pragma once

#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

/// Computes the Delaunay triangulation of points. Ties of cocircular points are broken by in_circle_perturbed.
/// Input:   pairwise different points in lexicographic order (x, then y); at most 2^28.
/// Output:  counter-clockwise triangles over the points' indices, each beginning with its smallest point; they are
///          ordered by that point, and around it counter-clockwise. Empty if all points are on one line.
/// Holds:   the triangles are the same as when any other triangulation of the points is flipped to be Delaunay. The
///          result has the same bytes for any number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) always; O(n) after sorting for evenly scattered points. Runs on the caller's TBB arena.
/// Source:  Guibas, Stolfi, Primitives for the Manipulation of General Subdivisions and the Computation of Voronoi
///          Diagrams, 1985, section 9; cuts in two directions as in Dwyer, A Faster Divide-and-Conquer Algorithm for
///          Constructing Delaunay Triangulations, 1987, but strips first.
Triangulation2d delaunay_divide_conquer(std::span<const Vec2> points, RunControl& control);

}  // namespace remesh
