/// What every triangulation in the plane must hold, tested the plain way.
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/triangulation_2d.h"
#include "core/triangulation/constraint_recovery.h"

namespace remesh {

using Corners = std::array<std::uint32_t, 3>;

/// Each begun at its smallest corner, sorted: equal for equal sets of triangles.
std::vector<Corners> canonical(std::vector<Corners> list);
std::vector<Corners> triangles_of(const Triangulation2d& mesh);
/// Pairs (smaller, larger).
std::set<Segment> edges_of(const Triangulation2d& mesh);
std::set<Segment> constrained_edges_of(const Triangulation2d& mesh);

/// Counter-clockwise triangles; twins that know each other and agree in ends and constraint.
void expect_valid(std::span<const Vec2> points, const Triangulation2d& mesh);
/// No free edge that a flip would improve, ties included.
void expect_locally_delaunay(std::span<const Vec2> points, const Triangulation2d& mesh);
double area_of(std::span<const Vec2> points, const Triangulation2d& mesh);
/// Points on the boundary of the convex hull, those inside its edges included.
std::size_t hull_size(std::span<const Vec2> sorted_points);
/// Whether the closed segments meet anywhere but in a common end, or a third point lies on one of them.
bool segments_conflict(std::span<const Vec2> points, const Segment& a, const Segment& b);
bool has_point_inside(std::span<const Vec2> points, const Segment& segment);

}  // namespace remesh
