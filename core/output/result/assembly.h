/// Joins the triangles of all patches into one mesh.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/patch_types/patch_mesh.h"

namespace remesh {

/// The output's triangles, ordered by patch. Their vertices are the essential ones in their input order.
struct Assembled {
  IdVector<VertexId, VertexId> vertex;  ///< the surface vertex of each output vertex, ascending
  IdVector<FaceId, Triangle> faces;
  IdVector<FaceId, PatchId> face_patch;
  std::vector<Vec2, DefaultInit<Vec2>> corner_uv;  ///< three per face
};

/// Joins the triangles of all patches over the vertices that they share.
/// Input:   `surface_vertices` is the number of the surface's vertices, including those that refinement made. There is
///          one mesh per patch.
/// Output:  the triangles as they are in the meshes, patch by patch. Vertices that no triangle uses are left out.
/// Holds:   the result is the same for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(vertices + triangles).
Assembled assembly(std::size_t surface_vertices, const PatchMeshes& meshes, RunControl& control);

}  // namespace remesh
