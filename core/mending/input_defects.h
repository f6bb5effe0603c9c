/// What is found in a welded surface without changing it.
#pragma once

#include <span>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Reports, from a welded surface: non_manifold_edge and open_boundary (elements: the input faces at such edges), and
/// non_manifold_vertex (elements: vertices where faces meet that are not connected there over edges).
/// Input:   as pinched_vertices finds them.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
void find_defects(const Surface& welded, const Adjacency& edges, std::span<const VertexId> pinched,
                  std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
