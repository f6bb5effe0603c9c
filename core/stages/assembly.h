/// Joins the patches' triangles into one mesh.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/mesh/mesh.h"
#include "core/stages/patch_meshing.h"

namespace remesh {

/// The output's triangles, by patch, over the essential vertices in their input order.
struct Assembled {
  IdVector<VertexId, VertexId> vertex;  ///< the surface vertex of each output vertex, ascending
  IdVector<FaceId, Triangle> faces;
  IdVector<FaceId, PatchId> face_patch;
  std::vector<Vec2, LeftUnset<Vec2>> corner_uv;  ///< three per face
};

Assembled assembly(std::size_t surface_vertices, const std::vector<PatchMesh>& meshes, RunControl& control);

}  // namespace remesh
