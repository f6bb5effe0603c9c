/// Measures what the turns between neighbouring facets imply about the surface from which the facets were made.
#pragma once

#include <cstdint>

#include "core/base/ids.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/facet_graph.h"

namespace remesh {

/// Returns the chord height that a facet would have on a surface that turns evenly from this facet to its neighbour
/// beyond a smooth side. The width of the narrower facet counts.
/// Input: a side of `p` with a valid FacetGraph::beyond. Lengths are in local units.
double implied_chord_height(const FacetGraph& graph, PatchId p, std::uint32_t side);

/// Returns the distance of a facet from a surface that the facet's turns against its neighbours explain. In each of the
/// two directions of the surface this is the chord height of the facet's own span. The surface may turn over the facet
/// only as far as the facets before and behind it turn against the facet, or twice as far if there is only one of them.
/// A direction without a neighbour that turns explains nothing. Every facet of an honest tessellation is explained.
/// Input:  a cylinder, cone, sphere or torus, in local units.
/// Source: rules.md, Evidence for surfaces.
double explained_height(const FacetGraph& graph, const AnalyticSurface& shape, PatchId p);

}  // namespace remesh
