#include "core/output/result/face_source.h"

#include <algorithm>

#include "core/base/blocks.h"
#include "core/base/large_first.h"
#include "core/patches/charts/patch_locator.h"

namespace remesh {

IdVector<FaceId, FaceId> face_source(const Surface& surface, const PatchSet& patches,
                                     const TriangulatedPatches& triangulated, RunControl& control) {
  const PatchMeshes& meshes = triangulated.meshes;
  std::vector<std::size_t> begin{0};
  for (const PatchMesh& patch : meshes) begin.push_back(begin.back() + patch.mesh.triangle_count());
  IdVector<FaceId, FaceId> source(begin.back());
  const auto work = [&](std::size_t p) { return patches.faces_of(PatchId(p)).size() + begin[p + 1] - begin[p]; };
  for_large_first(meshes.size(), kLargePatch, work, control, [&](std::size_t p) {
    const auto faces = patches.faces_of(PatchId(p));
    const PatchMesh& patch = meshes[PatchId(p)];
    if (faces.size() == 1) {
      std::fill(source.begin() + static_cast<std::ptrdiff_t>(begin[p]),
                source.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]), surface.face_source[faces[0]]);
      return;
    }
    const PatchLocator locator(surface, faces, triangulated.charts[PatchId(p)], control);
    for_blocks(patch.mesh.triangle_count(), kLookUps, control, [&](std::size_t first, std::size_t last) {
      for (auto t = static_cast<std::uint32_t>(first); t < last; ++t) {
        control.check();  // among needles, a search visits many faces
        const auto uv = [&](std::uint32_t k) { return patch.uv[patch.mesh.from(3 * t + k)]; };
        const Vec2 centroid = (1.0 / 3.0) * (uv(0) + uv(1) + uv(2));
        source[FaceId(begin[p] + t)] = surface.face_source[faces[locator.nearest(centroid).face]];
      }
    });
  });
  return source;
}

}  // namespace remesh
