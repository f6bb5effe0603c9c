/// Triangulates patches from their loops, all patches in parallel.
#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_set.h"
#include "core/geometry/triangulation_2d.h"
#include "core/mesh/surface.h"
#include "core/patches/boundary_loops.h"
#include "core/patches/essential_vertices.h"

namespace remesh {

/// The choice of the patches' x axes (see make_frame).
struct ProjectionRule {
  ReferenceAxis axis = ReferenceAxis::kDominantEdge;
  Vec3 direction;
};

/// Triangulates every patch from its essential vertices.
/// Output:  one mesh per patch, in the order of patches, for any number of threads.
/// Holds:   all loop edges are in the mesh. Plane coordinates are multiples of 2^-40, or of 2^-100 if points would meet
///          or loops cross on the coarser grid. A patch of one triangle cannot fail.
/// Cost:    O(n log n); on the caller's TBB arena, by patch, large ones first.
std::vector<PatchMesh> mesh_patches(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                                    const BoundaryLoops& loops, const EssentialVertices& essential,
                                    const ProjectionRule& rule, RunControl& control);

}  // namespace remesh
