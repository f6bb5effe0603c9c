/// Decides the max distance of the result from a torus.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// The facets of a surface, and their recognised surfaces.
struct TorusFacets {
  const Surface& surface;
  const PatchSet& facets;
  const RecognisedSurfaces& recognised;
  double plane_tolerance;  ///< model units
};

/// Reduces the limits of tori to the part of the tolerance that their facets do not use. On the outer half of the tube,
/// facets and result are both inside of it, so their distances from the surface do not add up. On the inner half, edges
/// around the axis are outside of the tube, and other edges are inside. There, the sum of both distances has to be
/// within the tolerance.
/// Input:  `limits` has one entry per surface, made from the same goals.
/// Output: tori whose facets are hardly outside of the tube may be as deep as their boundaries. Other tori stay as they
///         are if `elements_per_circle` is given. Otherwise they leave room for the way of boundaries along the
///         surface, and boundaries are no farther from the tube than the rest. If nothing is refined and the result,
///         or that of a second attempt, would have to be nearer to the tube than the facets are, the facets stay.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
/// Source: rules.md, Surface tolerance
void fit_limits_of_tori(const TorusFacets& input, const CurvedGoals& goals, std::vector<CurvedLimits>& limits,
                        RunControl& control);

}  // namespace remesh
