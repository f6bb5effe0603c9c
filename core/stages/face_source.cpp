#include "core/stages/face_source.h"

#include <tbb/blocked_range.h>

#include <algorithm>

#include "core/base/parallel.h"
#include "core/stages/patch_locator.h"

namespace remesh {

IdVector<FaceId, FaceId> face_source(const Surface& surface, const PatchSet& patches,
                                     const std::vector<PatchMesh>& meshes, RunControl& control) {
  std::vector<std::size_t> begin{0};
  for (const PatchMesh& patch : meshes) begin.push_back(begin.back() + patch.mesh.triangle_count());
  IdVector<FaceId, FaceId> source(begin.back());
  for_all(tbb::blocked_range<std::size_t>(0, meshes.size(), 64), [&](const auto& range) {
    for (std::size_t p = range.begin(); p < range.end(); ++p) {
      control.check();
      const auto faces = patches.faces_of(PatchId(p));
      const PatchMesh& patch = meshes[p];
      if (faces.size() == 1) {
        std::fill(source.begin() + static_cast<std::ptrdiff_t>(begin[p]),
                  source.begin() + static_cast<std::ptrdiff_t>(begin[p + 1]), surface.face_source[faces[0]]);
        continue;
      }
      const PatchLocator locator(surface, faces, patch.frame, control);
      for (std::uint32_t t = 0; t < patch.mesh.triangle_count(); ++t) {
        if (t % 4096 == 0) control.check();
        const auto uv = [&](std::uint32_t k) { return patch.uv[patch.mesh.from(3 * t + k)]; };
        const Vec2 centroid = (1.0 / 3.0) * (uv(0) + uv(1) + uv(2));
        source[FaceId(begin[p] + t)] = surface.face_source[faces[locator.nearest(centroid).face]];
      }
    }
  });
  return source;
}

}  // namespace remesh
