/// Fills a curved patch with columns of points.
#pragma once

#include <cstddef>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/refinement/refiner/working_patch.h"

namespace remesh {

/// A place for a point, and the distance of its column from the next one there. Both are in the plane of the chart.
struct ColumnPlace {
  Vec2 place;
  double spacing;
};

struct ColumnPlaces {
  Columns columns;
  std::vector<ColumnPlace> places;
};

/// Returns places for points of a curved patch, column after column.
/// Input:  a patch whose boundary is cut. `max_points` limits the result.
/// Output: places on the grid of the chart that may lie outside of the patch or near its boundary. None
///         if the surface has no axis or if there would be more than `max_points`.
/// Cost:   O(n) in the vertices of the patch and the points.
ColumnPlaces column_places(const WorkingPatch& patch, std::size_t max_points, RunControl& control);

}  // namespace remesh
