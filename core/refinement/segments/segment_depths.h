/// Finds the segments that have no room to follow the curved surfaces beside them, and limits how finely segments may
/// be cut.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/patches/charts/patch_chart.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {

/// Returns the min length of a segment's pieces that follows from the depth of the segment below the surfaces of curved
/// patches beside it. New vertices of such a patch lie on its surface. If pieces were shorter than the segment is deep,
/// these vertices would be near in the plane and far away in space, and no triangle there would have good angles. The
/// result is about 0 if cuts follow the curve in which the surfaces meet.
double floor_below_surface(const SegmentTable& table, SegmentId s, const PatchCharts& charts);

/// Returns the segments that would come too near to another boundary of a planar patch if they were cut on their
/// curves. In a sliver that is thinner than the cuts would move, the boundaries would cross.
/// Input:  `distance` gives the distance of each side of the table to the nearest feature, in model units.
/// Output: a segment may occur twice.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n) in the sides of the table.
std::vector<SegmentId> segments_without_room(const SegmentTable& table,
                                             const std::function<double(std::uint32_t)>& distance,
                                             const PatchCharts& charts, RunControl& control);

}  // namespace remesh
