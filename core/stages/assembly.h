/// Joins the patches' triangles into one mesh.
#pragma once

#include <vector>

#include "core/mesh/mesh.h"
#include "core/stages/patch_meshing.h"

namespace remesh {

/// The chord rule: an edge inside one patch must not be an edge of another patch too, nor a boundary edge, or the
/// surface would meet itself there. Of equal edges the one in the patch of lowest id stays (none, if one is a
/// boundary); in the others it is flipped, where the quadrilateral is strictly convex and the new edge is free. Output:
/// the patches in which that was not possible, ascending; they want a step of the ladder. Cost:    O(n log n) in the
/// patches' edges. Source:  REFINEMENT, rule 15.
std::vector<PatchId> resolve_chords(std::vector<PatchMesh>& meshes, RunControl& control);

/// The output's triangles, by patch, over the essential vertices in their input order.
struct Assembled {
  IdVector<VertexId, VertexId> vertex;  ///< the surface vertex of each output vertex, ascending
  IdVector<FaceId, Triangle> faces;
  IdVector<FaceId, PatchId> face_patch;
  std::vector<Vec2> corner_uv;  ///< three per face
};

Assembled assembly(std::size_t surface_vertices, const std::vector<PatchMesh>& meshes, RunControl& control);

}  // namespace remesh
