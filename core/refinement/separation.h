/// Moves new vertices apart that came to lie in one place.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patches/triangulated_patches.h"
#include "core/refinement/rounds.h"

namespace remesh {

/// Sheets that lie in one another are refined alike, so a new vertex of one may get exactly the coordinates of a vertex
/// of another. All but the first of such vertices are moved within their plane, by a few of the steps in which
/// coordinates there are rounded. The edges around them are made Delaunay again.
/// Input:  Refined patches. Only new vertices inside patches may be moved.
/// Output: Whether any vertex was moved.
/// Cost:   O(n log n) in the number of vertices.
bool separate_new_vertices(const Surface& surface, TriangulatedPatches& triangulated, Refinement& refinement,
                           RunControl& control);

}  // namespace remesh
