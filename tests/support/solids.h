/// Surfaces with as many random facets as a test wants, and the hard ones: sharp, thin, crowded.
///
/// As in shapes.h: welded vertices, all of them used, faces counter-clockwise from outside; a flat one faces +z.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/polygons.h"

namespace remesh::solids {

/// A plane region as triangles, z = 0.
PolygonMesh region(const polygons::Polygon& polygon);
/// A closed solid over a region: two caps of triangles, a quad a side.
PolygonMesh extrusion(const polygons::Polygon& polygon, double height);
/// The cube [-1, 1]^3 less what lies beyond each of so many random planes: convex, faces are polygons.
PolygonMesh cut_cube(std::uint64_t seed, int planes);
/// A mesh over a plane put onto another one: z becomes the height above that.
PolygonMesh placed(const PolygonMesh& mesh, const polygons::Placement& place);

/// `n` needle facets around the origin, each `degrees` wide there, with spokes one long that go up and down in turn: no
/// two facets share a plane.
PolygonMesh needle_fan(int n, double degrees);
/// One for each of these angles.
PolygonMesh needle_fan(const std::vector<double>& degrees);
/// A cone over a regular polygon around the origin, of radius 1: needles around its apex. The base is a polygon.
PolygonMesh cone(int sides, double height);
/// `n` square rings within each other, flat, `gap` wide and `gap` apart.
PolygonMesh nested_squares(int n, double gap);
/// A square tube of four walls, closed: its walls are `thickness` thick.
PolygonMesh tube(double width, double height, double thickness);
/// Boxes on top of each other, each with its whole skin: of each wall between two there are two sheets.
PolygonMesh stacked_boxes(int count, double length);

}  // namespace remesh::solids
