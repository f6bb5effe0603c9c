/// What CGAL says of points, triangulations and polygons in the plane: the oracle for ours.
///
/// CGAL's headers take longer to compile than most tests do, so only the source file of this one includes them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/base/vec.h"
#include "core/triangulation/constraint_recovery.h"
#include "tests/support/polygons.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {

/// Exact: 1 if the way from a over b to c turns left, -1 if it turns right, 0 on one line.
int cgal_orientation(Vec2 a, Vec2 b, Vec2 c);
/// Exact: 1 if d is inside the circle through abc, -1 outside, 0 on it; the other way round if abc turns right.
int cgal_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

/// All triangles of the convex hull, in any order.
std::vector<Corners> cgal_delaunay(std::span<const Vec2> points);
/// All triangles of the convex hull, canonical. The segments must not cross.
std::vector<Corners> cgal_cdt(std::span<const Vec2> points, std::span<const Segment> segments);

/// Why the loops are not simple, do not turn the right way, or are not pairwise without a common point; empty if all is
/// well.
std::string cgal_fault_of(const polygons::Polygon& polygon);

}  // namespace remesh
