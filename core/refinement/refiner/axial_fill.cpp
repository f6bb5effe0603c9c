#include "core/refinement/refiner/axial_fill.h"

#include <array>
#include <cmath>

#include "core/base/stoppable.h"
#include "core/patches/charts/curved_chart.h"
#include "core/refinement/segments/column_grid.h"

namespace remesh {

ColumnPlaces column_places(const WorkingPatch& patch, std::size_t max_points, RunControl& control) {
  ColumnPlaces result;
  const CurvedChart* const chart = patch.chart.curved();
  if (chart == nullptr) return result;
  StopCheck check(control);
  const auto position = [&](std::uint32_t v) { return patch.in_space[v].position; };
  std::vector<Vec3> vertices;
  for (std::uint32_t v = 0; v < patch.mesh.vertex_slots(); ++v) {
    check();
    if (patch.mesh.is_live_vertex(v)) vertices.push_back(position(v));
  }
  std::vector<std::array<Vec3, 2>> sides;
  for (std::uint32_t side = 0; side < patch.mesh.side_count(); ++side) {
    check();
    const std::uint32_t h = patch.mesh.half_edge_of_side(side);
    sides.push_back({position(patch.mesh.from(h)), position(patch.mesh.to(h))});
  }
  const ColumnGrid grid = column_grid(*chart, vertices, sides, control);
  if (!(grid.width > 0)) return result;
  result.columns = {grid.start, grid.width};
  if (!((grid.last - grid.first + 1) * (grid.rows / 2 + 1) <= static_cast<double>(max_points))) return result;
  for (double column = grid.first; column <= grid.last; ++column)
    for (double i = std::fmod(std::fabs(column), 2); i <= grid.rows; i += 2) {
      check();
      const Vec3 at = chart->map().point(SurfaceMap::Around{grid.start + column * grid.width, grid.low + i * grid.row});
      const Vec2 place = patch.chart.to_plane(at);
      result.places.push_back({place, grid.width * chart->map().radius(at) / patch.chart.scale(place)});
    }
  return result;
}

}  // namespace remesh
