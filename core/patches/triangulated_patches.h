/// The triangulated patches of a surface, with their charts.
#pragma once

#include <cstddef>

#include "core/geometry/patch_mesh.h"
#include "core/patches/patch_chart.h"

namespace remesh {

/// The patches' triangulations, and the charts in whose planes they lie. Refinement changes the triangulations; the
/// charts stay.
struct TriangulatedPatches {
  PatchMeshes meshes;
  PatchCharts charts;

  std::size_t size() const { return meshes.size(); }
};

}  // namespace remesh
