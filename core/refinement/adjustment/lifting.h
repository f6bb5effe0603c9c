/// Puts the new vertices of nearly flat patches onto the input surface under them.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/meshing/triangulated_patches.h"

namespace remesh {

/// A patch may leave its plane by up to the plane tolerance, so a new vertex in the plane may lie beside the input
/// surface. Lifting moves new vertices inside such a patch along its normal, up or down to the input face under them. A
/// vertex with an edge shorter than a hundred tolerances is not moved, because there the input's noise would turn the
/// faces.
/// Input:  Refined patches, and the positions of the new vertices. Those from `first_inner` on are inside patches, and
///         each lies where its patch's chart puts it. The tolerance is in model units.
/// Cost:   O((n + m) log n) for n input faces and m new vertices of such a patch.
/// Source: rules.md, Lifting.
void lift_new_vertices(const Surface& surface, const PatchSet& patches, const TriangulatedPatches& triangulated,
                       std::size_t first_inner, double plane_tolerance, std::vector<Vec3>& new_positions,
                       RunControl& control);

}  // namespace remesh
