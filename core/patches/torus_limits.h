/// Decides how far below a torus the result may be.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/surface.h"
#include "core/patches/curved_patches.h"
#include "core/patches/recognised_surfaces.h"

namespace remesh {

/// Lets the result be as deep below a torus as below other surfaces, if all of its facets are on the outer half of the
/// tube. There, facets and result are both inside of the tube, so their distances from the surface do not add up. On
/// the inner half, edges around the axis are outside of the tube, and others inside.
/// Input:  the patches are the facets that were recognised; `limits` has one entry per surface. Those of tori are for
///         the inner half.
/// Output: the limits of tori whose facets are nowhere farther outside of the tube than the plane tolerance.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
void deepen_tori(const Surface& surface, const PatchSet& facets, const RecognisedSurfaces& recognised,
                 double plane_tolerance, std::vector<CurvedLimits>& limits, RunControl& control);

}  // namespace remesh
