/// What is measured, where the shapes of the tests are too small or too simple.
#pragma once

#include "core/mesh/mesh.h"
#include "tests/support/polygons.h"

namespace remesh::bench {

/// A plate 4 by 3 with round holes of that many corners, and slots: what CAD packages cut.
polygons::Polygon plate(int holes_a_side, int corners);
/// A star with round tips of that many corners, each off the curve by a little, and square holes in rows: what is large
/// and has no sharp angles, at which CGAL would not end.
polygons::Polygon smooth_star(int corners, int holes_a_side);
/// A region as a mesh of its constrained Delaunay triangles: what our pipeline takes.
PolygonMesh mesh_of(const polygons::PatchInput& input);
/// nx x ny parallelograms of two triangles, `width` x 1 seen from above, over which the surface goes up and down so
/// that no two beside each other have one plane: z is a sum of one height a column and one a row.
PolygonMesh facets(int nx, int ny, double width);

}  // namespace remesh::bench
