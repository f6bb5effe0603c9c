/// Decides how far the result may be from each curved surface.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Returns the limits of all surfaces. The tolerance is 0 for planes, for free regions, and for surfaces whose own
/// facets in the input are farther away than is allowed: then no coarser result could be proven to be near enough.
/// Input:  the patches are the facets that were recognised.
/// Cost:   O(n).
std::vector<CurvedLimits> curved_limits(const Surface& surface, const PatchSet& facets,
                                        const RecognisedSurfaces& recognised, const CurvedGoals& goals,
                                        double plane_tolerance, RunControl& control);

}  // namespace remesh
