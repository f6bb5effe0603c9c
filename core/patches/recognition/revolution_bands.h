/// Joins bands of facets around an axis to surfaces of revolution.
#pragma once

#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// Joins claims for cones and cylinders about one axis, which meet smoothly, to surfaces of revolution. They are no
/// pieces of a common sphere or torus, because such a surface would have replaced them.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
void join_bands(const FacetGraph& graph, ClaimTable& table, RunControl& control);

}  // namespace remesh
