/// Moves new vertices apart that came to lie in one place.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/mesh/surface.h"
#include "core/refinement/rounds.h"

namespace remesh {

/// Sheets that lie in one another are refined alike, and a vertex of one may get the very coordinates of another's. All
/// but the first of such vertices move within their plane, by a few of the steps in which coordinates there are
/// rounded, and the edges around them are made Delaunay again.
/// Input:   refined patches; vertices inside patches may be moved, no others.
/// Output:  whether any was moved.
/// Cost:    O(n log n) in the vertices.
bool separate_new_vertices(const Surface& surface, std::vector<PatchMesh>& meshes, Refinement& refinement,
                           RunControl& control);

}  // namespace remesh
