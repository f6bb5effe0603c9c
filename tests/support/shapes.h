/// Small surfaces made on the spot, and what tests do to them: moved, scaled, renumbered, joined.
///
/// Every generator gives welded vertices (no two with equal coordinates), all of them used, and faces counter-clockwise
/// from outside; a flat sheet faces +z. Sizes are in model units and chosen so that coordinates are exact.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh::shapes {

/// A mesh from lists, as one would write it by hand.
PolygonMesh from_lists(const std::vector<Vec3>& positions, const std::vector<std::vector<std::uint32_t>>& faces);

/// The same triangles as a triangle mesh. Input: a mesh of triangles only.
TriangleMesh as_triangles(const PolygonMesh& mesh);

// Flat sheets, z = 0.

/// The cells of a drawing: every '#' is a unit square of two triangles, cut `cuts` x `cuts`; the bottom row has y in
/// [0, 1]. Cells that touch in a corner share that vertex only.
///   flat({"##", "#."}) is an L; flat({"###", "#.#", "###"}) is a plate with a square hole.
PolygonMesh flat(const std::vector<std::string_view>& rows, int cuts = 1);
/// One polygon face through these points, which run counter-clockwise.
PolygonMesh polygon(const std::vector<Vec2>& points);
/// A triangle with that angle at the origin, its sides there so long, the first one along x.
PolygonMesh triangle(double degrees, double first, double second);
/// A rectangle of nx x ny squares of two triangles each.
PolygonMesh sheet(double width, double height, int nx, int ny);
/// The square ring of J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 1.1: outer square +-4, inner
/// square +-3, z = 1; 8 triangles and then `cuts` x `cuts` of each.
PolygonMesh ring(int cuts = 1);
/// A square plate +-2 with a round hole of radius 1 and `sides` sides in the middle (a multiple of 4).
PolygonMesh plate_with_round_hole(int sides);
/// A plate of 5 x 3 cells with a slot one cell wide, open to the upper border: the border's two halves are collinear.
PolygonMesh slotted_plate(int cuts = 1);
/// Two squares that meet in one vertex.
PolygonMesh two_squares_touching_at_a_vertex(int cuts = 1);
/// A square sheet twice, facing up and down, over the same vertices: closed, no volume.
PolygonMesh double_sheet(int cuts = 1);
/// Random points of a square grid's cells, four triangles a cell: `n` x `n` cells with inner points moved.
PolygonMesh noisy_sheet(int n, unsigned seed);

// Solids.

/// A box from the origin to `size`, each side cut into n x n squares of two triangles.
PolygonMesh box(const Vec3& size, int n = 1);
/// The same of quads.
PolygonMesh quad_box(const Vec3& size, int n = 1);
/// The cells of a drawing (see `flat`) as unit cubes: closed, without inner walls; all squares as two triangles.
/// Cells that touch in a corner share a vertical edge with four faces.
PolygonMesh blocks(const std::vector<std::string_view>& rows, int cuts = 1);
/// An L of three cubes.
PolygonMesh l_bracket(int cuts = 1);
/// A prism over a simple counter-clockwise polygon: two polygon caps and a quad per side.
PolygonMesh prism(const std::vector<Vec2>& base, double height);
/// A prism over a regular polygon; caps are polygons.
PolygonMesh cylinder(int sides, double radius, double height);
/// An octahedron subdivided `levels` times onto the unit sphere: every face its own plane.
PolygonMesh sphere(int levels);
/// Three rectangles that share one edge: a book with three pages.
PolygonMesh three_pages(int cuts = 1);

// What tests do to them.

PolygonMesh moved(PolygonMesh mesh, const Vec3& by);
PolygonMesh scaled(PolygonMesh mesh, double factor);
/// Turned about `axis` through the origin; rounding noise included.
PolygonMesh rotated(PolygonMesh mesh, const Vec3& axis, double angle_deg);
/// Every coordinate rounded to a multiple of `step`.
PolygonMesh rounded(PolygonMesh mesh, double step);
/// The same surface with vertices and faces in another order and every face begun at another corner.
PolygonMesh renumbered(const PolygonMesh& mesh, unsigned seed);
/// All faces turned over.
PolygonMesh turned_over(PolygonMesh mesh);
/// Both, side by side; equal coordinates stay separate vertices.
PolygonMesh joined(const PolygonMesh& a, const PolygonMesh& b);
/// Vertices with equal coordinates become one; order of first use.
PolygonMesh welded(const PolygonMesh& mesh);
/// Each face as a fan from its first corner: for convex faces only.
PolygonMesh fan_triangulated(const PolygonMesh& mesh);

/// The faces as triangles; every face must be one.
TriangleMesh triangles(const PolygonMesh& mesh);
PolygonMesh polygons(const TriangleMesh& mesh);
/// The mesh as a working surface, vertex and face numbers unchanged, no barrier; local coordinates as from weld.
Surface surface(const PolygonMesh& mesh);

}  // namespace remesh::shapes
