/// Proves claims whose corners are farther from their surface than rounding explains.
#pragma once

#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// Returns whether a claim is believed although its corners are off its surface by more than rounding, as the corners
/// of some programs are. All of this must hold:
/// - There are at least eight facets, and twice as many corners as the kind has parameters.
/// - In each direction in which the surface bends, the whole claim rises by at least eight times the deviation of its
///   corners.
/// - No kind with more parameters halves the deviation.
/// - A surface that is fitted to either half of the claim, in each of the two directions, is within the claim's
///   tolerance of all corners.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   some fits to the corners.
/// Source: rules.md, Ends of surfaces.
bool is_loose_claim_proven(const FacetGraph& graph, const SurfaceClaim& claim, RunControl& control);

}  // namespace remesh
