/// Begins the refinement of a patch.
#pragma once

#include <cstdint>
#include <memory_resource>

#include "core/base/run_control.h"
#include "core/refinement/refiner/patch_boundary.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/patch_to_refine.h"
#include "core/refinement/segments/segment_cuts.h"
#include "core/refinement/segments/vertex_place.h"
#include "core/triangulation/delaunay_mesh.h"

namespace remesh {

/// A patch at the moment when its refinement begins. It may already have points that divide its boundary and fill its
/// inside evenly.
struct PatchStart {
  DelaunayMesh mesh;
  std::pmr::vector<VertexPlace> places;  ///< one per vertex
  PatchBoundary boundary;
};

/// Triangulates a patch anew from its cut boundary and from lattices of points inside, if there are sizes. Without
/// sizes, or if that would change nothing, or if rounding prevents it, the patch begins as it was triangulated before.
/// Input:  `cuts` has the cuts of every segment, ascending. There are at most about `quota` triangles.
/// Output: The vertices are those of the patch, then those on its boundary, then those inside. Either all cuts of the
///         patch's segments are made or none of them.
/// Cost:   O((t + n) log n) for t triangles and n points.
PatchStart start_patch(const PatchToRefine& patch, const PatchSizes& sizes, const SegmentCuts::OfSegments& cuts,
                       std::uint64_t quota, DelaunayMesh::Scratch& scratch, std::pmr::memory_resource* memory,
                       RunControl& control);

}  // namespace remesh
