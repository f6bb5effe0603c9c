/// Fills an area evenly with points.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// Gives the longest edge that is allowed at each place of the plane.
struct PlaneSizes {
  std::function<double(Vec2)> at;
  /// Returns whether the length is at most the size at all places within the radius around `place`. The answer may also
  /// be false although this is so.
  std::function<bool(double length, Vec2 place, double radius)> allows;
  bool is_uniform = true;   ///< the size is the same everywhere
  double noise = 0;         ///< sizes that are meant to be equal differ by less than this fraction
  double look_up_cost = 1;  ///< the time of a look-up, relative to a usual one
};

/// Returns points of lattices of equilateral triangles, inside a region and away from its boundary. The lattices' edges
/// are no longer than the size at their place. Refinement fills the rest, between the points and the boundary. The
/// edges of each lattice are half as long as those of the next coarser one, and it has all points of that one. Rows run
/// along x.
///
/// If there is one size, or nearly one, the lattice is stretched to fit the bounding box of the region. The number of
/// columns is the smallest that the size allows. If the lower side of the box has only a few more pieces than that,
/// there are as many columns as pieces. Rows are as high as the slanting edges allow. If there is room, the first and
/// the last row are in step with the vertices along the lower and the upper side.
/// Input:  The triangles cover the region. `boundary` holds points of its boundary; where the boundary can be cut, they
///         are no more than half the size there apart. The first `vertex_count` of them are the region's vertices. No
///         point of the result is nearer than `shortest` to a point of `boundary`.
/// Output: The points in lexicographic order. There are none if there would be more than `max_points`, or if too many
///         cells of the lattices would have to be visited, compared with the number of points, boundary points and
///         triangles.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O((t + n) log n) for t triangles and n points, if the triangles are a Delaunay triangulation of the
///         boundary.
std::vector<Vec2> lattice_fill(std::span<const std::array<Vec2, 3>> triangles, std::span<const Vec2> boundary,
                               std::size_t vertex_count, const PlaneSizes& sizes, double shortest,
                               std::size_t max_points, RunControl& control);

}  // namespace remesh
