/// Decides how far the result may be from each curved surface.
#pragma once

#include <optional>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/surface.h"
#include "core/patches/curved_patches.h"
#include "core/patches/recognised_surfaces.h"

namespace remesh {

/// Returns whether some surface may be remeshed with a number of edges per full turn.
bool may_elements_be_in_force(const Options& options);

/// Returns the number of edges per full turn with which a surface is remeshed, if there is one.
/// elements_per_circle=auto has one for surfaces with more than 32.5 facets per turn.
std::optional<double> elements_per_circle_of(const RecognisedSurface& surface, const Options& options);

/// Returns the limits of all surfaces. The tolerance is 0 for planes, for free regions, and for surfaces from which
/// the input's own facets are farther than is allowed: no coarser result could be proven to be near enough to them.
/// Input:  `diagonal` is the diagonal of the input's bounding box. The patches are the facets that were recognised.
/// Cost:   O(n).
std::vector<CurvedLimits> curved_limits(const Surface& surface, const PatchSet& facets,
                                        const RecognisedSurfaces& recognised, const Options& options,
                                        double plane_tolerance, double diagonal, RunControl& control);

}  // namespace remesh
