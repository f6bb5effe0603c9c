/// Moves new vertices apart that have equal coordinates.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patches/triangulated_patches.h"
#include "core/refinement/rounds.h"

namespace remesh {

/// Two sheets of the surface may lie in the same place. They are then refined in the same way, so a new vertex of one
/// sheet may get exactly the coordinates of a vertex of the other. Of the vertices with equal coordinates, the first
/// stays. The others are moved within the plane of their patch, by a few rounding steps of doubles of that size. The
/// edges around a moved vertex are made Delaunay again.
/// Input:  Refined patches. Only new vertices inside patches may be moved.
/// Output: Whether any vertex was moved.
/// Cost:   O(n log n) in the number of vertices.
bool separate_new_vertices(const Surface& surface, TriangulatedPatches& triangulated, Refinement& refinement,
                           RunControl& control);

}  // namespace remesh
