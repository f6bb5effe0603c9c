/// Drops claims that fit by chance.
#pragma once

#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// Drops small claims in the middle of many facets that belong to no claim. They fit by chance, because a small piece
/// of any smooth surface is nearly a piece of a cylinder or a torus.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
void drop_false_fits(const FacetGraph& graph, ClaimTable& table, RunControl& control);

}  // namespace remesh
