#include "core/refinement/segments/column_cuts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/stoppable.h"
#include "core/refinement/segments/column_grid.h"

namespace remesh {
namespace {

/// A segment runs along a column if the angles of its ends around the axis differ by less than this part of a column,
/// and differ from the column's angle by less than this part.
constexpr double kAlong = 1e-3;
/// A cut is at least this many rows away from both ends of its segment.
constexpr double kMinRows = 0.7;
/// Beside a plane, the points serve the curved patch alone. They save more triangles there than they add in the plane
/// if the curved patch has at least this many columns.
constexpr double kManyColumns = 6;
/// A patch never asks for more cuts of one segment than this.
constexpr double kMaxCuts = 1 << 20;

bool is_ruled(const AnalyticSurface& shape) {
  return shape.kind == SurfaceKind::kCylinder || shape.kind == SurfaceKind::kCone;
}

/// Returns the cuts of a segment that runs along a column.
std::vector<double> cuts_in_rows(const SegmentTable& table, SegmentId s, const SurfaceMap& map,
                                 const ColumnGrid& grid) {
  const Vec3 start = table.position(s, 0);
  const SurfaceMap::Around from = map.around(start), to = map.around(table.position(s, 1));
  const double column = (0.5 * (from.angle + to.angle) - grid.start) / grid.width, nearest = std::nearbyint(column);
  const bool is_along = std::fabs(to.angle - from.angle) < kAlong * grid.width;
  if (!is_along || std::fabs(column - nearest) > kAlong) return {};
  const double begin = (from.way - grid.low) / grid.row, end = (to.way - grid.low) / grid.row;
  const double low = std::min(begin, end) + kMinRows, high = std::max(begin, end) - kMinRows;
  // Segments that end at the apex of a cone get no cuts. The apex is far below the lowest row.
  if (!(low > -1) || !(high - low < kMaxCuts)) return {};
  const double shift = std::fmod(std::fabs(nearest), 2);
  std::vector<double> cuts;
  for (double i = 2 * std::ceil((low - shift) / 2) + shift; i <= high; i += 2) {
    const Vec3 place = map.point(SurfaceMap::Around{from.angle, grid.low + i * grid.row});
    cuts.push_back(norm(place - start) / table[s].length);
  }
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

/// Returns whether all pieces are at least as long as the segment's floor.
bool are_long_enough(const std::vector<double>& cuts, const BoundarySegment& segment) {
  double before = 0;
  for (std::size_t i = 0; i <= cuts.size(); ++i) {
    const double here = i < cuts.size() ? cuts[i] : 1;
    if (!((here - before) * segment.length > segment.floor) || !(here > before)) return false;
    before = here;
  }
  return true;
}

}  // namespace

std::map<SegmentId, std::vector<double>> column_cuts(const TriangulatedPatches& triangulated, const SegmentTable& table,
                                                     const Goals& goals, const SizeField& sizes, RunControl& control) {
  std::map<SegmentId, std::vector<double>> result;
  if (!triangulated.charts.has_curved() || goals.min_angle_deg == 0) return result;
  // Patches with sizes are filled evenly.
  if (!sizes.is_uniform() || std::isfinite(sizes.largest())) return result;
  StopCheck check(control);
  for (PatchId p(0); p.value < triangulated.size(); ++p.value) {
    check();
    const PatchChart chart = triangulated.charts[p];
    // Boundaries along the tube of a torus are curves that have been divided.
    if (chart.curved() == nullptr || !is_ruled(chart.curved()->map().shape())) continue;
    const PatchMesh& patch = triangulated.meshes[p];
    if (patch.has_rulings) continue;  // strips have no columns
    std::vector<Vec3> vertices;
    for (const VertexId v : patch.vertices) vertices.push_back(table.surface().positions[v]);
    std::vector<std::array<Vec3, 2>> sides;
    const auto own = table.sides_of_patch(p);
    for (const std::uint32_t i : own) {
      check();
      const std::uint32_t h = table.all_sides()[i].half_edge;
      sides.push_back({vertices[patch.mesh.from(h)], vertices[patch.mesh.to(h)]});
    }
    const ColumnGrid grid = column_grid(*chart.curved(), vertices, sides, control);
    if (!(grid.width > 0) || !(grid.last - grid.first > 1)) continue;
    for (const std::uint32_t i : own) {
      check();
      const SegmentId s = table.all_sides()[i].segment;
      const BoundarySegment& segment = table[s];
      if (segment.is_locked() || segment.ring_base[0] > 0 || segment.ring_base[1] > 0) continue;
      // A plane does not need the vertices of columns.
      const auto beside = table.sides(s);
      const bool has_plane = std::any_of(beside.begin(), beside.end(), [&](const SegmentSide& side) {
        return triangulated.charts[side.patch].curved() == nullptr;
      });
      if (has_plane && grid.last - grid.first < kManyColumns) continue;
      std::vector<double> cuts = cuts_in_rows(table, s, chart.curved()->map(), grid);
      if (cuts.empty() || !are_long_enough(cuts, segment)) continue;
      std::vector<double>& known = result[s];
      const bool is_better = cuts.size() != known.size() ? cuts.size() > known.size() : cuts < known;
      if (is_better) known = std::move(cuts);
    }
  }
  return result;
}

}  // namespace remesh
