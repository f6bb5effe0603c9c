/// CGAL's results for points, triangulations and polygons in the plane. They are the oracle for ours.
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

/// An exact test.
/// Output: 1 if the way from a over b to c turns left, -1 if it turns right, 0 if the points are on one line.
int cgal_orientation(Vec2 a, Vec2 b, Vec2 c);
/// An exact test.
/// Output: 1 if d is inside the circle through abc, -1 if it is outside, 0 if it is on the circle; the signs are
///         swapped if abc turns right.
int cgal_in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

/// Returns all triangles of the Delaunay triangulation of the convex hull, in any order.
std::vector<Corners> cgal_delaunay(std::span<const Vec2> points);
/// Returns all triangles of the constrained triangulation of the convex hull, in canonical form. The segments must
/// not cross.
std::vector<Corners> cgal_cdt(std::span<const Vec2> points, std::span<const Segment> segments);

/// Explains why a polygon is not valid: its loops are not simple, do not turn the right way, or have common points.
/// Output: empty if it is valid.
std::string cgal_fault_of(const polygons::Polygon& polygon);

}  // namespace remesh
