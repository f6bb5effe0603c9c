/// The checker's own exact arithmetic. Plane coordinates are multiples of a grid, so integers of fixed width decide;
/// shares nothing with geometry/predicates.
#pragma once

#include "core/base/vec.h"

namespace remesh::verification {

/// The two grids that a frame may have.
inline constexpr double kCoarseGrid = 0x1p-40;
inline constexpr double kFineGrid = 0x1p-100;

/// Is `uv` what a frame stores: within [-1, 1] and a multiple of `grid`?
bool is_on_grid(Vec2 uv, double grid);

/// Sign of the signed area of abc, > 0 counter-clockwise. All points are on the grid, which is one of the two.
int orientation(Vec2 a, Vec2 b, Vec2 c, double grid);

/// Is d strictly inside the circle of the counter-clockwise abc? All points are on the grid.
bool is_inside_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d, double grid);

/// Are the three points of space exactly on one line? Exact as long as no product underflows.
bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh::verification
