/// Surfaces with as many random facets as a test wants, and difficult ones: sharp, thin, crowded.
///
/// The same is true as in shapes.h: vertices are welded and all used, and faces are counter-clockwise from outside; a
/// flat surface faces +z.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/polygons.h"

namespace remesh::solids {

/// Makes a plane region as triangles with z = 0.
PolygonMesh region(const polygons::Polygon& polygon);
/// Makes a closed solid over a region, with two caps of triangles and one quad per side.
PolygonMesh extrusion(const polygons::Polygon& polygon, double height);
/// Makes the cube [-1, 1]^3 without the parts beyond each of `planes` random planes. It is convex, and its faces are
/// polygons.
PolygonMesh cut_cube(std::uint64_t seed, int planes);
/// Moves a mesh over a plane onto another plane. z becomes the height above that plane.
PolygonMesh placed(const PolygonMesh& mesh, const polygons::Placement& place);

/// Makes `n` needle facets around the origin. Each is `degrees` wide there, with spokes of length one that go up and
/// down in turn, so no two facets share a plane.
PolygonMesh needle_fan(int n, double degrees);
/// Makes one needle for each of these angles.
PolygonMesh needle_fan(const std::vector<double>& degrees);
/// Makes a cone over a regular polygon of radius 1 around the origin, with needles around its apex. The base is a
/// polygon.
PolygonMesh cone(int sides, double height);
/// Makes `n` flat square rings within each other, `gap` wide and `gap` apart.
PolygonMesh nested_squares(int n, double gap);
/// Makes a closed square tube of four walls, which are `thickness` thick.
PolygonMesh tube(double width, double height, double thickness);
/// Makes boxes on top of each other, each with its whole skin. So each wall between two boxes consists of two sheets.
PolygonMesh stacked_boxes(int count, double length);

}  // namespace remesh::solids
