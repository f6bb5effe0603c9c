/// Small surfaces that tests make, and functions that move, scale, renumber and join them.
///
/// Every generator makes welded vertices (no two have equal coordinates), which are all used. Faces are
/// counter-clockwise from outside, and a flat sheet faces +z. Sizes are in model units and chosen so that coordinates
/// are exact.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "tests/support/random.h"

namespace remesh::shapes {

/// Makes a mesh from lists, as one would write it by hand.
PolygonMesh from_lists(const std::vector<Vec3>& positions, const std::vector<std::vector<std::uint32_t>>& faces);

/// Returns the same triangles as a triangle mesh.
/// Input: a mesh of triangles only.
TriangleMesh as_triangles(const PolygonMesh& mesh);

// These functions make flat sheets in the plane z = 0.

/// Makes the cells of a drawing: every '#' is a unit square of two triangles, cut `cuts` x `cuts`. The bottom row has
/// y in [0, 1]. Cells that touch in a corner share that vertex only.
/// For example, flat({"##", "#."}) is an L, and flat({"###", "#.#", "###"}) is a plate with a square hole.
PolygonMesh flat(const std::vector<std::string_view>& rows, int cuts = 1);
/// Makes one polygon face through these points, which run counter-clockwise.
PolygonMesh polygon(const std::vector<Vec2>& points);
/// Makes a triangle with that angle at the origin and sides of these lengths there, the first one along x.
PolygonMesh triangle(double degrees, double first, double second);
/// Makes a rectangle of nx x ny squares of two triangles each.
PolygonMesh sheet(double width, double height, int nx, int ny);
/// Makes the square ring with outer square +-4, inner square +-3 and z = 1. It has 8 triangles, each cut into `cuts`
/// x `cuts`.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 1.1.
PolygonMesh ring(int cuts = 1);
/// Makes a square plate +-2 with a round hole of radius 1 and `sides` sides in the middle. The number of sides is a
/// multiple of 4.
PolygonMesh plate_with_round_hole(int sides);
/// Makes a plate of 5 x 3 cells with a slot one cell wide, open to the upper border. The border's two halves are
/// collinear.
PolygonMesh slotted_plate(int cuts = 1);
/// Makes two squares that meet in one vertex.
PolygonMesh two_squares_touching_at_a_vertex(int cuts = 1);
/// Makes a square sheet twice over the same vertices, facing up and down. It is closed and has no volume.
PolygonMesh double_sheet(int cuts = 1);
/// Makes a sheet of `n` x `n` cells whose inner grid points are moved at random. Each cell is four triangles around its
/// middle.
PolygonMesh noisy_sheet(int n, unsigned seed);

// These functions make solids.

/// Makes a box from the origin to `size`. Each side is cut into n x n squares of two triangles.
PolygonMesh box(const Vec3& size, int n = 1);
/// Makes the same box of quads.
PolygonMesh quad_box(const Vec3& size, int n = 1);
/// Makes the cells of a drawing (see `flat`) as unit cubes. The surface is closed, without inner walls, and every
/// square is two triangles. Cells that touch in a corner share a vertical edge with four faces.
PolygonMesh blocks(const std::vector<std::string_view>& rows, int cuts = 1);
/// Makes blocks by a drawing of so many cells a side, of which about 60 % are drawn at random. (2, 2) always is.
PolygonMesh random_blocks(Random& random, int side, int cuts);
/// Makes faces through random points of a small grid. They cross, repeat, fold, and lie flat on a line, and an edge has
/// any number of faces.
PolygonMesh random_soup(Random& random, int max_corners);
/// Makes an L of three cubes.
PolygonMesh l_bracket(int cuts = 1);
/// Makes a prism over a simple counter-clockwise polygon, with two polygon caps and one quad per side.
PolygonMesh prism(const std::vector<Vec2>& base, double height);
/// Makes a prism over a regular polygon. The caps are polygons.
PolygonMesh cylinder(int sides, double radius, double height);
/// Makes a sphere from an octahedron that is subdivided `levels` times. Every face is its own plane.
PolygonMesh sphere(int levels);
/// Makes three rectangles that share one edge, like a book with three pages.
PolygonMesh three_pages(int cuts = 1);

// These functions make surfaces with details.

/// Makes a unit cube whose upper edge at the front is split by a facet of this height, over half of which it bulges.
PolygonMesh cube_with_needle(double height);
/// Makes a sheet of two unit squares, and a triangle of this height that stands on their common edge.
/// Input: `is_closed` - the triangle is there twice, facing both ways.
PolygonMesh sheet_with_flap(double height, bool is_closed);

// These functions change surfaces.

PolygonMesh moved(PolygonMesh mesh, const Vec3& by);
PolygonMesh scaled(PolygonMesh mesh, double factor);
/// Turns a mesh about `axis` through the origin. The result has rounding noise.
PolygonMesh rotated(PolygonMesh mesh, const Vec3& axis, double angle_deg);
/// Rounds every coordinate to a multiple of `step`.
PolygonMesh rounded(PolygonMesh mesh, double step);
/// Returns the same surface with vertices and faces in another order, where every face begins at another corner.
PolygonMesh renumbered(const PolygonMesh& mesh, unsigned seed);
/// Turns all faces over.
PolygonMesh turned_over(PolygonMesh mesh);
/// Puts both meshes into one. Equal coordinates stay separate vertices.
PolygonMesh joined(const PolygonMesh& a, const PolygonMesh& b);
/// A strip in the plane z = 0 that goes 450 degrees round, so that the border of its one patch crosses itself.
PolygonMesh strip_over_itself();
/// Merges vertices with equal coordinates. Vertices are numbered by first use.
PolygonMesh welded(const PolygonMesh& mesh);
/// Divides each face into a fan from its first corner. The faces must be convex.
PolygonMesh fan_triangulated(const PolygonMesh& mesh);

/// Returns the faces as triangles. Every face must be one.
TriangleMesh triangles(const PolygonMesh& mesh);
PolygonMesh polygons(const TriangleMesh& mesh);
/// Returns the mesh as a working surface with the same vertex and face numbers, without barriers. Local coordinates
/// are those of weld.
Surface surface(const PolygonMesh& mesh);

}  // namespace remesh::shapes
