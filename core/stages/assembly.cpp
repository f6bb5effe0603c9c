#include "core/stages/assembly.h"

namespace remesh {
Assembled assembly(std::size_t surface_vertices, const std::vector<PatchMesh>& meshes, RunControl& control) {
  control.check();
  std::vector<VertexId> number(surface_vertices);
  std::size_t faces = 0;
  for (const PatchMesh& patch : meshes) {
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); ++h)
      number[patch.vertices[patch.mesh.from(h)].value] = VertexId(0);
    faces += patch.mesh.triangle_count();
  }
  Assembled out;
  for (std::uint32_t v = 0; v < surface_vertices; ++v)
    if (number[v].is_valid()) number[v] = out.vertex.push_back(VertexId(v));
  out.faces.reserve(faces);
  out.face_patch.reserve(faces);
  out.corner_uv.reserve(3 * faces);
  for (std::uint32_t p = 0; p < meshes.size(); ++p) {
    const PatchMesh& patch = meshes[p];
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
      Triangle triangle;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t i = patch.mesh.from(h + k);
        triangle[k] = number[patch.vertices[i].value];
        out.corner_uv.push_back(patch.uv[i]);
      }
      out.faces.push_back(triangle);
      out.face_patch.push_back(PatchId(p));
    }
  }
  return out;
}

}  // namespace remesh
