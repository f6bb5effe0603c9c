/// Points that fill an area evenly.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// The longest edge at each place of the plane.
struct PlaneSizes {
  std::function<double(Vec2)> at;
  /// Is a length at most the size at all places within a radius of this one? False may also be said where it is so.
  std::function<bool(double length, Vec2 place, double radius)> allows;
  bool is_uniform = true;  ///< the same everywhere
  double noise = 0;        ///< sizes that are meant to be the same differ by less than this part
};

/// Points of lattices of equilateral triangles, whose edges are at most the size there, inside a region and away from
/// its boundary: what lies between is left to refinement. Each lattice has half the edges of the next coarser one, and
/// all its points; rows run along x. Of one size, or nearly, the lattice fits the region's box: its columns as many as
/// they must be, or as the lower side has pieces if these are few more; its rows as high as the slanting edges allow,
/// the first and the last in step with the vertices along the lower and the upper side, if there is room.
/// Input:  triangles that cover the region; points of its boundary, half the size there apart or less where it can be
///         cut, the first `vertex_count` of them its vertices; `shortest`: no point is nearer to these.
/// Output: in lexicographic order; empty if there would be more than `most`, or if more than some times as many cells
///         of the lattices would have to be looked at as there are points, boundary points and triangles.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O((t + n) log n) for t triangles and n points, where the triangles are a Delaunay triangulation of the
///         boundary.
std::vector<Vec2> even_fill(std::span<const std::array<Vec2, 3>> triangles, std::span<const Vec2> boundary,
                            std::size_t vertex_count, const PlaneSizes& sizes, double shortest, std::size_t most,
                            RunControl& control);

}  // namespace remesh
