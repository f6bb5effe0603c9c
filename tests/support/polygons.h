/// Random but repeatable polygons with holes and sets of points in the plane, with sizes that tests choose.
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

/// A polygon whose loops are simple and neither cross nor touch. `outer` is counter-clockwise, and `holes` are
/// clockwise and inside it.
struct Polygon {
  Loop outer;
  std::vector<Loop> holes;
};

// These functions make polygons.

/// Makes a polygon that is star-shaped around the origin within radius 1, with 4 or more corners. In an inner square
/// of cells x cells, each cell may have a star-shaped hole, by chance. Neighbouring holes come close without
/// touching.
Polygon star_with_holes(std::uint64_t seed, int corners, int cells);
/// Makes an arbitrary simple polygon, grown from a triangle on an integer grid of width `size`. It is spiky, with
/// collinear corners and corners that nearly touch edges. It has at most `corners` corners, and fewer if the grid is
/// full.
Polygon grown(std::uint64_t seed, int corners, int size);
/// Makes columns of random whole heights above and below the x axis, some with a square hole. There are only right
/// angles and collinear corners.
Polygon rectilinear_with_holes(std::uint64_t seed, int columns);
/// Makes a comb with teeth of this height. The teeth are one wide and one apart, on a back that is one high.
Polygon comb(int teeth, int height);
/// Makes a band of `turns` quarter turns around its start. The band and its gaps are one wide.
Polygon spiral(int turns);
/// Makes an L of three unit squares.
Polygon l_shape();
/// Makes the square [0, 1]^2 with n x n square holes.
Polygon sieve(int n);

double area(const Loop& loop);
double area(const Polygon& polygon);

/// A polygon in the form that the stages need: all corners in lexicographic order, and every loop edge with the
/// inside on its left.
struct PatchInput {
  std::vector<Vec2> points;
  std::vector<Segment> edges;
};
PatchInput patch_input(const Polygon& polygon);

// These functions make sets of different points in lexicographic order.

/// Makes points in [-1, 1)^2 whose coordinates are multiples of 2^-40, without ties.
std::vector<Vec2> scattered(std::uint64_t seed, int n);
/// Makes an integer grid from which each point is taken with this probability.
std::vector<Vec2> grid(int nx, int ny, double probability = 1, std::uint64_t seed = 1);
/// Makes an integer grid that is turned and rounded to multiples of 2^-40. It is cocircular and collinear except for
/// rounding.
std::vector<Vec2> turned_grid(int nx, int ny, double angle);
/// Makes the 324 integer points of the circle x^2 + y^2 = 32045^2, which are exactly cocircular.
std::vector<Vec2> cocircular();
/// Makes n points of the unit circle, rounded to multiples of 2^-40.
std::vector<Vec2> nearly_cocircular(int n);
/// Makes the points (i, i^2) for |i| <= n. They are convex, and the worst case for a sweep.
std::vector<Vec2> parabola(int n);
/// Makes n points on each of `lines` lines that are parallel to the direction (dx, dy), at random whole places.
std::vector<Vec2> on_lines(std::uint64_t seed, int lines, int n, int dx, int dy);
/// Makes n points in each of `count` clusters, which are 2^-20 wide.
std::vector<Vec2> clusters(std::uint64_t seed, int count, int n);

/// Sorts points and removes repetitions.
std::vector<Vec2> sorted_unique(std::vector<Vec2> points);

// These place a plane in space.

/// A plane in space. `x_axis` and `y_axis` are orthogonal to rounding and have the length of one unit of the plane.
struct Placement {
  Vec3 origin;
  Vec3 x_axis{1, 0, 0};
  Vec3 y_axis{0, 1, 0};

  Vec3 operator()(Vec2 p) const { return origin + p.x * x_axis + p.y * y_axis; }
};
/// Makes a random rotation and a random shift of this scale.
Placement random_placement(std::uint64_t seed, double scale);

}  // namespace remesh::polygons
