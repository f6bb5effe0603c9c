/// Finds the facets with sharp corners.
#pragma once

#include <cstdint>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/boundary_loops.h"
#include "core/patches/essential_vertices.h"

namespace remesh {

/// Finds the facets in which no refinement can meet a bound on angles, because a corner of their outline is sharper.
/// Input:  `max_angle_deg` is that bound, in degrees.
/// Output: one entry per patch, which is 1 if some corner between two straight parts of its outline is sharper.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
IdVector<PatchId, std::uint8_t> find_sharp_facets(const Surface& surface, const Adjacency& adjacency,
                                                  const PatchSet& patches, const BoundaryLoops& loops,
                                                  const EssentialVertices& essential, double max_angle_deg,
                                                  RunControl& control);

}  // namespace remesh
