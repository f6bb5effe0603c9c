/// Cuts polygons over which other faces lie.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A polygon and triangles that cover it are duplicates, but no two of these faces have the same loop. So polygons are
/// cut like the triangles that lie over them, if these have no corners but the polygon's own. Then each piece of the
/// polygon has the loop of a triangle.
/// Input:   a welded surface; the tolerance, in local units. If a polygon leaves its plane by more than that, only
///          triangles with the same orientation are its copies: others may enclose something together with it.
/// Output:  the surface with the pieces in the place of their polygon.
/// Returns: whether the surface changed.
/// Cost:    O(n) if no triangle has two edges with a polygon in common, otherwise O(n log n).
bool cut_covered_polygons(Surface& surface, const Adjacency& edges, double tolerance, RunControl& control);

}  // namespace remesh
