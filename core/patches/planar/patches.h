/// Numbers the patches, which are the edge-connected pieces of regions.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/planar/regions.h"

namespace remesh {

/// Makes the patches of the regions.
/// Input:  if `regions.are_connected` is set, each region is a piece; this is not checked.
/// Output: one patch per edge-connected piece of a region, numbered by its first face.
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 3; rules.md, Connected patches.
PatchSet patches(const Surface& surface, const Adjacency& adjacency, const Regions& regions, RunControl& control);

}  // namespace remesh
