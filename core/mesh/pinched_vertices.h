/// Finds the vertices where a surface touches itself.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Returns the vertices, ascending, whose faces fall into several fans that have no edge in common. A fan may have any
/// number of faces.
/// Cost: O(n log n) at worst.
std::vector<VertexId> pinched_vertices(const Surface& surface, const Adjacency& edges, RunControl& control);

}  // namespace remesh
