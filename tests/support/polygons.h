/// Polygons with holes and sets of points in the plane, random but repeatable, with sizes that tests choose.
///
/// Coordinates are multiples of 2^-40 or coarser, so that their differences are exact.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/triangulation/constraint_recovery.h"
#include "tests/support/random.h"

namespace remesh::polygons {

using Loop = std::vector<Vec2>;

/// Simple loops that neither cross nor touch: `outer` counter-clockwise, `holes` clockwise and inside it.
struct Polygon {
  Loop outer;
  std::vector<Loop> holes;
};

// Polygons.

/// Star-shaped around the origin within radius 1, with 4 or more corners; in an inner square of cells x cells, every
/// cell has a star-shaped hole by chance. Neighbouring holes come close without touching.
Polygon star_with_holes(std::uint64_t seed, int corners, int cells);
/// Any simple polygon, grown from a triangle on an integer grid of width `size`: spiky, with collinear corners and
/// corners that nearly touch edges. Has at most `corners` corners, fewer if the grid is full.
Polygon grown(std::uint64_t seed, int corners, int size);
/// Columns of random whole heights above and below the x axis, some with a square hole: right angles and collinear
/// corners only.
Polygon rectilinear_with_holes(std::uint64_t seed, int columns);
/// A comb with teeth of this height, each one wide and one apart from the next, on a back that is one high.
Polygon comb(int teeth, int height);
/// A band one wide around its start, with gaps one wide: `turns` quarter turns.
Polygon spiral(int turns);
/// An L of three unit squares.
Polygon l_shape();
/// The square [0, 1]^2 with n x n square holes.
Polygon sieve(int n);

double area(const Loop& loop);
double area(const Polygon& polygon);

/// A polygon as the stages take it: all corners in lexicographic order, and every loop edge, the inside on its left.
struct PatchInput {
  std::vector<Vec2> points;
  std::vector<Segment> edges;
};
PatchInput patch_input(const Polygon& polygon);

// Sets of different points, in lexicographic order.

/// In [-1, 1)^2, multiples of 2^-40, without ties.
std::vector<Vec2> scattered(std::uint64_t seed, int n);
/// The integer grid, each point kept with this probability.
std::vector<Vec2> grid(int nx, int ny, double probability = 1, std::uint64_t seed = 1);
/// The integer grid turned and rounded to multiples of 2^-40: cocircular and collinear but for rounding.
std::vector<Vec2> turned_grid(int nx, int ny, double angle);
/// The 324 integer points of the circle x^2 + y^2 = 32045^2: exactly cocircular.
std::vector<Vec2> cocircular();
/// n points of the unit circle, rounded to multiples of 2^-40.
std::vector<Vec2> nearly_cocircular(int n);
/// (i, i^2) for |i| <= n: convex, and a sweep's worst case.
std::vector<Vec2> parabola(int n);
/// n points on each of `lines` lines, parallel to the direction (dx, dy), at random whole places.
std::vector<Vec2> on_lines(std::uint64_t seed, int lines, int n, int dx, int dy);
/// n points in each of `count` clusters, each 2^-20 wide.
std::vector<Vec2> clusters(std::uint64_t seed, int count, int n);

/// Sorted, and each point once.
std::vector<Vec2> sorted_unique(std::vector<Vec2> points);

// Placing in space.

/// A plane in space: `x_axis` and `y_axis` are orthogonal to rounding and as long as one unit of the plane.
struct Placement {
  Vec3 origin;
  Vec3 x_axis{1, 0, 0};
  Vec3 y_axis{0, 1, 0};

  Vec3 operator()(Vec2 p) const { return origin + p.x * x_axis + p.y * y_axis; }
};
/// A random rotation and shift of this scale.
Placement random_placement(std::uint64_t seed, double scale);

}  // namespace remesh::polygons
