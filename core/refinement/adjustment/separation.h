/// Moves new vertices apart that have equal coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/rounds/rounds.h"

namespace remesh {

/// The vertices whose places new vertices must not have.
enum class TwinsOf {
  kPatches,  ///< vertices that patches have
  /// Also vertices of the surface that no patch has any more. In most cases, a new vertex in the place of such a vertex
  /// is right. It is wrong if it is in another patch than the old vertex.
  kSurface,
};

/// Two sheets of the surface may lie in the same place. They are then refined in the same way, so a new vertex of one
/// sheet may get exactly the coordinates of a vertex of the other. Of the vertices with equal coordinates, the first
/// stays. The others are moved within the plane of their patch, by a few rounding steps of the coordinates there. The
/// edges around a moved vertex are made Delaunay again.
/// Input:  Refined patches. Only new vertices inside patches may be moved.
/// Output: One entry per vertex of the surface and of the refinement, not 0 if the vertex was moved. It is empty if
///         none was. A triangle that flips have changed has the reason `effort`.
/// Cost:   O(n log n) in the number of vertices; O(1) if there is no new vertex inside a patch.
std::vector<std::uint8_t> separate_new_vertices(const Surface& surface, TriangulatedPatches& triangulated,
                                                Refinement& refinement, TwinsOf of, RunControl& control);

}  // namespace remesh
