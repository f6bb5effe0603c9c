/// Finds the input face under each output face.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/meshing/triangulated_patches.h"

namespace remesh {

/// Output: for each output face, in assembly's order, the input face (in the input's numbering) that contains its
///         centroid in the plane of their patch. If rounding or a dropped vertex leaves no such face, it is the nearest
///         one.
/// Cost:   O((n + m) log n) for a patch with n input and m output faces, by a tree of boxes.
IdVector<FaceId, FaceId> face_source(const Surface& surface, const PatchSet& patches,
                                     const TriangulatedPatches& triangulated, RunControl& control);

}  // namespace remesh
