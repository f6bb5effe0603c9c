/// Vertices where a surface touches itself.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Vertices, ascending, at which the faces fall into fans that have no edge in common, of however many faces.
/// Cost: O(n log n) at worst.
std::vector<VertexId> pinched_vertices(const Surface& surface, const Adjacency& edges, RunControl& control);

}  // namespace remesh
