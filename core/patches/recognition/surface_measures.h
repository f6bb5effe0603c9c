/// Measures the facets of a recognised surface.
#pragma once

#include "core/base/run_control.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// Measures of facets, relative to their surface.
struct FacetMeasures {
  double chord_height = 0;  ///< largest distance of the facets from the surface, at their sides and in their middles
  double explained = 0;     ///< the largest explained_height of a facet; 0 for surfaces of revolution
  double turn_deg = 0;      ///< largest angle by which the surface turns along a side
  double sweep_deg = 0;     ///< how much of a full turn around the axis they cover; 0 for spheres, which have no axis
};

/// Measures the facets of a claim. Corners within `tolerance` of the axis have no angle around it. All lengths are in
/// local units.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n) in the facets.
FacetMeasures measure_facets(const FacetGraph& graph, const SurfaceClaim& claim, const AnalyticSurface& shape,
                             double tolerance, RunControl& control);

}  // namespace remesh
