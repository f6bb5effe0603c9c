/// Drops claims of single rows of facets along a tube that bends.
#pragma once

#include "core/base/run_control.h"
#include "core/patches/recognition/facet_graph.h"
#include "core/patches/recognition/region_growing.h"

namespace remesh {

/// Drops cylinders, cones and tori of so few rows along a tube that some round surface always fits, if the tube
/// continues beyond them in another direction. Such rows are pieces of a tube that bends, like a hose.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
/// Source: rules.md, Ends of surfaces.
void drop_bends(const FacetGraph& graph, ClaimTable& table, RunControl& control);

}  // namespace remesh
