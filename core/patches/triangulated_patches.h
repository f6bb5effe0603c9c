/// The triangulated patches of a surface, with their charts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>

#include "core/geometry/patch_mesh.h"
#include "core/patches/patch_chart.h"

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
};

}  // namespace remesh
