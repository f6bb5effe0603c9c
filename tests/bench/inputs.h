/// Inputs of the measurements, for which the shapes of the tests are too small or too simple.
#pragma once

#include "core/mesh/mesh.h"
#include "tests/support/polygons.h"

namespace remesh::bench {

/// Makes a plate of 4 by 3 with slots and with round holes of that many corners, as CAD packages cut it.
polygons::Polygon plate(int holes_a_side, int corners);
/// Makes a star with round tips of that many corners, each a little off the curve, and with square holes in rows.
/// The region is large and has no sharp angles, since CGAL would not end at those.
polygons::Polygon smooth_star(int corners, int holes_a_side);
/// Turns a region into a mesh of its constrained Delaunay triangles, since our pipeline takes meshes.
PolygonMesh mesh_of(const polygons::PatchInput& input);
/// Makes nx x ny parallelograms of two triangles each. Seen from above, each is `width` x 1. The surface goes up and
/// down, so that no two parallelograms beside each other are in one plane: z is the sum of one height per column and
/// one per row.
PolygonMesh facets(int nx, int ny, double width);
/// Makes a smooth ball with bumps, from an icosahedron with `cuts` pieces along each edge. Its coordinates are floats,
/// no two neighbours are in one plane, and all angles are above 25 degrees.
PolygonMesh bumpy_ball(int cuts);
/// Makes a terrain of n x n squares of two triangles each, with hills of all sizes down to a square. Its coordinates
/// are floats.
PolygonMesh terrain(int n);
/// Makes the surface on which a smooth function of space is 0, as it comes out of a lattice of n cells along each axis:
/// each cell is divided into six tetrahedra, and the surface is plane in each. Many of the triangles are small or
/// narrow.
PolygonMesh isosurface(int n);
/// Makes a tube around a knot that lies on a torus: `around` facets around the tube, and 25 times as many along it, of
/// two triangles each. Its coordinates are floats.
PolygonMesh knot_tube(int around);
/// Makes an open part of Enneper's minimal surface of n x n facets of two triangles each. Its coordinates are floats.
PolygonMesh enneper_patch(int n);

}  // namespace remesh::bench
