/// Measures how finely surfaces are divided into facets.
#pragma once

#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/facets.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Sets how many facets a full turn of each surface has (RecognisedSurface::facets_per_turn). The turn from a facet to
/// its neighbour is measured on the surface, from the corners of the facet: their rounding is small beside the radius,
/// while it is large beside a facet, whose normal it tilts. A triangle that is half of a bent quad counts as the quad.
///  - Around an axis, and around the tube of a torus, the turn is the angle that a facet covers.
///  - On a sphere, it is the angle that a facet covers across the side behind which a neighbour lies, where this is
///    largest.
///  - Along the profile of a surface of revolution, it is the angle between neighbouring bands.
/// The turns of a direction count by the areas of the facets, and their median is taken. A direction in which nearly no
///   facet has a neighbour of the same surface does not count. The result is the number of the direction with the
///   fewest facets. Bands get the number of their surface of revolution.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n) in the facets.
void measure_turns(const Facets& facets, const FacetGraph& graph, RecognisedSurfaces& recognised, RunControl& control);

}  // namespace remesh
