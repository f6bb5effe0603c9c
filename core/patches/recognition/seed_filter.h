/// Tells quickly where no surface begins.
#pragma once

#include <span>

#include "core/base/ids.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/surface_gauge.h"
#include "core/patches/recognition/surface_seeds.h"

namespace remesh {

/// Returns the kinds of those surfaces that SeedGuesses makes of two facets and that pass near the corners of two of
/// their neighbours. On scans there are few, and the test takes a fraction of the time of a guess.
/// Input:  a seed, and the tolerance of growths from it. The test allows twice the slack of these, since its surfaces
///         differ from the guesses by rounding.
/// Output: all kinds if there are many facets around the two.
SurfaceKinds kinds_that_may_begin(const FacetGraph& graph, const SurfaceSeed& seed, double tolerance);

/// Returns whether a surface passes through enough facets around two facets to be believed, claimed or not. Otherwise
/// hardly any growth that begins with this surface comes to something.
bool may_grow(const FacetGraph& graph, const AnalyticSurface& start, std::span<const PatchId> pair, double tolerance);

}  // namespace remesh
