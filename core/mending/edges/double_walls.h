/// Makes the two sides of a wall between two solids independent of each other.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Two solids that touch have a wall twice. An edge inside the wall that both sides have in common has four faces. No
/// patch may grow over such an edge, so the edge would be in the result as well. So the faces of one side become one
/// polygon, where they lie in one plane. Then the edges inside the wall belong to the other side alone.
/// Input:   a welded surface; the labels of the input that it came from; the tolerance of planes, in local units.
///          Walls with a face that is marked in `keep_verbatim` stay as they are; see mend_faces.
/// Output:  the surface with a polygon for one side of each flat wall whose outline is one simple loop. Which side that
///          is does not depend on the order of the faces. The polygon comes from the first of the faces that it
///          replaces, all of which have the same labels.
/// Returns: whether the surface changed.
/// Cost:    O(n) if no edge has four faces, otherwise O(n log n).
bool part_double_walls(Surface& surface, const Adjacency& edges, const FaceLabels& labels, double tolerance,
                       const std::vector<std::uint8_t>& keep_verbatim, RunControl& control);

}  // namespace remesh
