/// Makes what lies within a distance of each other shared: vertices, edges and faces that touch.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/solids/cut_plan.h"
#include "core/solids/soup.h"

namespace remesh {

/// Plans what makes triangles share vertices and edges where they lie within a distance of each other:
/// - of two near vertices, the one with the smaller number stays;
/// - an edge gets the vertices that are near it, and a face those near its inside;
/// - two edges that pass each other get a common new point, or a vertex that is there;
/// - a piece of an edge with both ends on a face becomes an edge of this face;
/// - two faces that have points in common, not all near one line, are triangulated together.
/// Input:   `active` is empty, or says which faces count. A contact needs at least one of these.
/// Output:  the plan, which is empty if nothing is near anything else; then are_all_apart is set, unless faces
///          intersect or some are not active. New points are appended to the soup's positions. Nothing, if too many
///          faces are near each other.
/// Holds:   every contact is decided once, for all faces that it concerns. The result depends on places and on the
///          numbers of vertices and faces, and not on threads.
/// Errors:  kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) and the pairs of near faces, whose number is bounded.
std::optional<CutPlan> find_contacts(Soup& soup, const SoupEdges& edges, double distance,
                                     std::span<const std::uint8_t> active, RunControl& control);

}  // namespace remesh
