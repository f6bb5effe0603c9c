/// The triangulated patches of a surface, with their charts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/base/ids.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patches/charts/patch_chart.h"

namespace remesh {

/// The patches' triangulations, and the charts in whose planes they lie. Refinement changes the triangulations; the
/// charts stay.
struct TriangulatedPatches {
  PatchMeshes meshes;
  PatchCharts charts;

  std::size_t size() const { return meshes.size(); }
  /// Returns the number of triangles of all patches.
  std::uint64_t triangle_count() const {
    return std::accumulate(meshes.begin(), meshes.end(), std::uint64_t{0},
                           [](std::uint64_t sum, const PatchMesh& patch) { return sum + patch.mesh.triangle_count(); });
  }
  /// Returns the corners of the triangles of all patches, three for each.
  std::vector<VertexId> corners() const {
    std::vector<VertexId> result;
    result.reserve(3 * triangle_count());
    for (const PatchMesh& patch : meshes)
      for (std::uint32_t h = 0; h < 3 * patch.mesh.triangle_count(); ++h)
        result.push_back(patch.vertices[patch.mesh.from(h)]);
    return result;
  }
};

}  // namespace remesh
