/// Makes the list of surfaces from the claims of facets.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/facets.h"
#include "core/patches/recognition/recognised_surfaces.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// Joins claims for equal surfaces, measures all surfaces, and divides the facets of no claim into planes and free
/// regions.
/// Input:  no facet is in two claims.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
RecognisedSurfaces make_recognised_list(const Facets& facets, const FacetGraph& graph, std::vector<SurfaceClaim> claims,
                                        const RecognitionRules& rules, RunControl& control);

}  // namespace remesh
