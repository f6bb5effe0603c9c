/// Triangulates patches from their loops, all patches in parallel.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/chains/curve_cuts.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/charts/patch_chart.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"

namespace remesh {

/// The patches that are curved, and the vertices between which boundaries were cut anew for them.
struct CurvedBoundaries {
  const CurvedPatches& patches;
  const CurveCuts& cuts;
};

/// Triangulates every patch from its essential vertices.
/// Input:   the surface and the patches must outlive the charts. `curves` is null if no patch is curved. Otherwise the
///          surface has the new vertices of its cuts, too.
/// Output:  the same for any number of threads.
/// Holds:   all loop edges are in the mesh. Plane coordinates are multiples of 2^-40, or of 2^-100 if points would meet
///          or loops cross on the coarser grid. A patch of one triangle cannot fail.
/// Cost:    O(n log n); on the caller's TBB arena, by patch, large ones first.
TriangulatedPatches mesh_patches(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                                 const BoundaryLoops& loops, const EssentialVertices& essential,
                                 const ProjectionRule& rule, RunControl& control,
                                 const CurvedBoundaries* curves = nullptr);

}  // namespace remesh
