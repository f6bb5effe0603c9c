/// Tests the properties of every triangulation in the plane by simple means.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "core/triangulation/constraint_recovery.h"
#include "core/triangulation/triangulation_2d.h"

namespace remesh {

using Corners = std::array<std::uint32_t, 3>;

/// Returns the triangles sorted, each beginning at its smallest corner. Equal sets of triangles give equal lists.
std::vector<Corners> canonical(std::vector<Corners> list);
std::vector<Corners> triangles_of(const Triangulation2d& mesh);
/// Returns edges as pairs (smaller, larger).
std::set<Segment> edges_of(const Triangulation2d& mesh);
std::set<Segment> constrained_edges_of(const Triangulation2d& mesh);

/// Expects counter-clockwise triangles, and twins that refer to each other and agree in their ends and constraints.
void expect_valid(std::span<const Vec2> points, const Triangulation2d& mesh);
/// Expects that no unconstrained edge would be improved by a flip, ties included.
void expect_locally_delaunay(std::span<const Vec2> points, const Triangulation2d& mesh);
double area_of(std::span<const Vec2> points, const Triangulation2d& mesh);
/// Returns the number of points on the boundary of the convex hull, including those inside its edges.
std::size_t hull_size(std::span<const Vec2> sorted_points);
/// True if the closed segments meet anywhere except in a common end, or if a third point lies on one of them.
bool segments_conflict(std::span<const Vec2> points, const Segment& a, const Segment& b);
bool has_point_inside(std::span<const Vec2> points, const Segment& segment);

}  // namespace remesh
