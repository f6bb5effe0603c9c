#include "core/output/result/assembly.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "core/base/blocks.h"

namespace remesh {
namespace {

/// The triangles of all patches, one patch after the other.
class AllTriangles {
 public:
  AllTriangles(const PatchMeshes& meshes, RunControl& control) : control_(control), begin_(meshes.size() + 1, 0) {
    for (std::size_t p = 0; p < meshes.size(); ++p)
      begin_[p + 1] = begin_[p] + meshes[PatchId(p)].mesh.triangle_count();
  }

  std::size_t count() const { return begin_.back(); }

  /// Calls visit(number, patch, first half-edge in the patch) for each triangle, in parallel.
  template <class Visit>
  void for_each(const Visit& visit) const {
    for_blocks(count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      auto p = static_cast<std::size_t>(std::upper_bound(begin_.begin(), begin_.end(), begin) - begin_.begin()) - 1;
      for (std::size_t f = begin; f < end; ++f) {
        while (f >= begin_[p + 1]) ++p;
        visit(FaceId(f), PatchId(p), static_cast<std::uint32_t>(3 * (f - begin_[p])));
      }
    });
  }

 private:
  RunControl& control_;
  std::vector<std::size_t> begin_;  ///< first number of each patch's triangles; one entry more than there are patches
};

}  // namespace

Assembled assembly(std::size_t surface_vertices, const PatchMeshes& meshes, RunControl& control) {
  const AllTriangles triangles(meshes, control);
  const auto vertex = [&](PatchId p, std::uint32_t h) {
    const PatchMesh& patch = meshes[PatchId(p)];
    return patch.vertices[patch.mesh.from(h)];
  };
  std::vector<std::uint8_t> is_used(surface_vertices, 0);
  triangles.for_each([&](FaceId, PatchId p, std::uint32_t h) {
    for (std::uint32_t k = 0; k < 3; ++k)
      std::atomic_ref(is_used[vertex(p, h + k).value]).store(1, std::memory_order_relaxed);
  });
  Assembled out;
  out.vertex.items() =
      select_ids<VertexId>(surface_vertices, kItemsPerBlock, control, [&](std::size_t v) { return is_used[v] != 0; });
  std::vector<VertexId> number(surface_vertices);
  for_blocks(out.vertex.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) number[out.vertex[VertexId(i)].value] = VertexId(i);
  });
  out.faces.resize(triangles.count());
  out.face_patch.resize(triangles.count());
  out.corner_uv.resize(3 * triangles.count());
  triangles.for_each([&](FaceId f, PatchId p, std::uint32_t h) {
    out.face_patch[f] = p;
    for (std::uint32_t k = 0; k < 3; ++k) {
      out.faces[f][k] = number[vertex(p, h + k).value];
      out.corner_uv[3 * std::size_t{f.value} + k] = meshes[PatchId(p)].uv[meshes[PatchId(p)].mesh.from(h + k)];
    }
  });
  return out;
}

}  // namespace remesh
