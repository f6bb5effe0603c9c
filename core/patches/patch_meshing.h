/// One patch, from its loops to its triangles; all patches in parallel.
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

/// How patches are projected.
struct ProjectionRule {
  ReferenceAxis axis = ReferenceAxis::kDominantEdge;
  Vec3 direction;
};

/// Triangulates every patch from its essential vertices.
/// Output:  one mesh per patch, in patch order, whatever the number of threads.
/// Holds:   loops are kept; plane coordinates are multiples of 2^-40, or of 2^-100 where the coarser grid makes points
///          meet or loops cross. A patch of one triangle cannot fail.
/// Cost:    O(n log n); on the caller's TBB arena, by patch, large ones first.
std::vector<PatchMesh> mesh_patches(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                                    const BoundaryLoops& loops, const EssentialVertices& essential,
                                    const ProjectionRule& rule, RunControl& control);

}  // namespace remesh
