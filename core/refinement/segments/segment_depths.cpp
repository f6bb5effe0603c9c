#include "core/refinement/segments/segment_depths.h"

#include <algorithm>
#include <cmath>

#include "core/base/stoppable.h"

namespace remesh {

double floor_below_surface(const SegmentTable& table, SegmentId s, const PatchCharts& charts) {
  double depth = 0;
  if (!charts.has_curved()) return 0;
  for (const SegmentSide& side : table.sides(s)) {
    const PatchChart chart = charts[side.patch];
    if (chart.curved() == nullptr) continue;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0})
      depth = std::max(depth, std::fabs(chart.height(table.position(s, t))));
  }
  constexpr double kPerDepth = 2;
  return kPerDepth * depth;
}

std::vector<SegmentId> segments_without_room(const SegmentTable& table,
                                             const std::function<double(std::uint32_t)>& distance,
                                             const PatchCharts& charts, RunControl& control) {
  // Two boundaries that both move by half of the distance between them meet exactly.
  constexpr double kShareOfRoom = 0.5;
  std::vector<SegmentId> found;
  if (!charts.has_curved()) return found;
  StopCheck check(control);
  for (std::uint32_t i = 0; i < table.all_sides().size(); ++i) {
    check();
    const SegmentSide& side = table.all_sides()[i];
    if (charts[side.patch].curved() != nullptr) continue;
    const SegmentId s = side.segment;
    const Vec3 &from = table.surface().positions[table[s].from], &to = table.surface().positions[table[s].to];
    double moved = 0;
    for (const double t : {0.25, 0.5, 0.75})
      moved = std::max(moved, norm(table.position(s, t) - (from + t * (to - from))));
    if (moved > kShareOfRoom * distance(i)) found.push_back(s);
  }
  return found;
}

}  // namespace remesh
