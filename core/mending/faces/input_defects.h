/// Reports defects of a welded surface without changing it.
#pragma once

#include <span>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Reports three defects of a welded surface: non_manifold_edge and open_boundary (elements are the input faces at such
/// edges), and non_manifold_vertex (elements are vertices whose faces are not all connected over edges there).
/// Input:   `pinched` are the vertices that pinched_vertices finds.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
void find_defects(const Surface& welded, const Adjacency& edges, std::span<const VertexId> pinched,
                  std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
