/// The columns of points with which a curved patch is filled, and the rows in them.
#pragma once

#include <array>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/patches/charts/curved_chart.h"

namespace remesh {

/// The columns of a curved patch and the rows in them. Column c is at the angle start + c * width around the axis. Its
/// points are in every second row: in the even rows if c is even, and otherwise in the odd ones. Row i is at low + i *
/// row, a length along the axis that is measured as in SurfaceMap::Around.
struct ColumnGrid {
  double start = 0, width = 0;        ///< without columns the width is 0
  double first = 0, last = 0;         ///< the first and the last column in the patch
  double low = 0, row = 0, rows = 0;  ///< rows run from 0 to `rows`
};

/// Returns the columns of a patch. A column runs along the surface's axis, and points of neighbouring columns are half
/// a step apart. Columns are as far from each other as edges may turn, and steps are so long that the edges along the
/// columns are still those of a Delaunay triangulation: such triangles are the largest ones around an axis, with angles
/// of 45 and 90 degrees. If the boundary is divided into equal pieces around the axis, columns begin at its vertices.
/// Input:  the vertices of the patch and the two ends of each side of it, in space.
/// Output: no columns if the surface has no axis.
/// Cost:   O(n).
ColumnGrid column_grid(const CurvedChart& chart, std::span<const Vec3> vertices,
                       std::span<const std::array<Vec3, 2>> sides, RunControl& control);

}  // namespace remesh
