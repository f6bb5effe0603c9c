/// Cuts the boundary of curved patches where columns of points inside end beside it.
#pragma once

#include <map>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// Returns where segments along the axis of a cylinder or a cone are cut before all other cuts. Such a segment is a
/// column itself, so it gets the points of a column, one in every second row. If it was halved again and again instead,
/// its points would not fit those of the columns beside it, and triangles there would have to be refined. Segments
/// beside a plane are left out if there are few columns, because the cuts would add more triangles in the plane than
/// they save.
/// Input:  the sides of the table.
/// Output: ascending parameters, only for segments with cuts. There are none if angles have no bound, if sizes have
///         one, or if the patch has no column inside. If the patches on both sides ask for different cuts, the longer
///         list is taken, and of equally long lists the smaller one.
/// Cost:   O(n) in the sides of curved patches and in the cuts.
std::map<SegmentId, std::vector<double>> column_cuts(const TriangulatedPatches& triangulated, const SegmentTable& table,
                                                     const Goals& goals, const SizeField& sizes, RunControl& control);

}  // namespace remesh
