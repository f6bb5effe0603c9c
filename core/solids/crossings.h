/// Finds where triangles of a soup cross each other at an angle.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/solids/cut_plan.h"
#include "core/solids/soup.h"

namespace remesh {

/// The curves along which triangles cross.
struct Crossings {
  CutPlan plan;
  std::size_t curves = 0;    ///< the number of pairs of faces with a curve
  bool is_too_much = false;  ///< too many curves cross each other in faces, so the plan is not complete
};

/// Plans to cut faces that cross each other along their curves. The ends of a curve lie where an edge passes through a
/// face, and curves of three faces meet in one point. Each such point is computed once, from what makes it, and is
/// rounded once. Points with equal coordinates are one.
/// Input:   pairs of faces that intersect, ascending, the smaller face first. Edges that only touch faces are left.
/// Output:  new points are appended to the soup's positions.
/// Holds:   signs that decide are exact, or at least known with numbers of twice the usual precision: what these cannot
///          tell from 0 counts as 0, and crosses nothing. The result is the same for any number of threads.
/// Errors:  kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(k log k) for k pairs, and the pairs of curves in a face whose boxes meet, whose number is bounded.
Crossings find_crossings(Soup& soup, const SoupEdges& edges, const std::vector<std::pair<FaceId, FaceId>>& pairs,
                         RunControl& control);

}  // namespace remesh
