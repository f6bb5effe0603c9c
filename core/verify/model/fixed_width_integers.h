/// The checker's own exact arithmetic. Plane coordinates are multiples of a grid, so integers of fixed width give
/// exact results. It shares nothing with geometry/predicates.
#pragma once

#include "core/base/vec.h"

namespace remesh::verification {

/// The two grids that a frame may have.
inline constexpr double kCoarseGrid = 0x1p-40;
inline constexpr double kFineGrid = 0x1p-100;

/// True if `uv` is a point that a frame may store: within [-1, 1] and a multiple of `grid`.
bool is_on_grid(Vec2 uv, double grid);

/// The sign of the signed area of abc, which is positive if abc is counter-clockwise.
/// Input: points on the grid, which is one of the two.
int orientation(Vec2 a, Vec2 b, Vec2 c, double grid);

/// True if d is strictly inside the circle through the counter-clockwise triangle abc.
/// Input: points on the grid.
bool is_inside_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d, double grid);

/// True if three points in space are exactly on one line. The result is exact as long as no product underflows.
bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh::verification
