/// Puts the new vertices of nearly flat patches onto the input surface under them.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/surface.h"

namespace remesh {

/// A patch may leave its plane by up to the tolerance, and what is put into the plane then is beside the input. New
/// vertices inside such a patch move along its normal, up or down to the input face under them; but none does that has
/// an edge shorter than a hundred tolerances: there the input's noise would turn the faces.
/// Input:  refined patches; positions of the new vertices, of which those from `first_inner` on are inside patches,
///         each in the plane of its patch; the tolerance in model units.
/// Cost:   O((n + m) log n) for n input faces and m new vertices of such a patch.
/// Source: rules.md, Lifting.
void lift_new_vertices(const Surface& surface, const PatchSet& patches, const std::vector<PatchMesh>& meshes,
                       std::size_t first_inner, double plane_tolerance, std::vector<Vec3>& new_positions,
                       RunControl& control);

}  // namespace remesh
