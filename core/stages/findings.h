/// What is found in the input without changing it.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/report.h"

namespace remesh {

/// Reports, from a welded surface: non_manifold_edge, open_boundary and inconsistent_winding (elements: the input faces
/// at such edges), inside_out (one for a closed surface that encloses a negative volume).
void find_defects(const Surface& welded, const Adjacency& edges, const MeshStatistics& statistics,
                  std::vector<Diagnostic>& diagnostics);

/// The faces as triangles, polygons split by split_polygon; for measuring the quality of the input.
std::vector<Triangle> triangulated(const Surface& surface, RunControl& control);

}  // namespace remesh
