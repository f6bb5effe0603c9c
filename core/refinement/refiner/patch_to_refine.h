/// A reference to a patch that is to be refined.
#pragma once

#include "core/patch_types/patch_mesh.h"
#include "core/patches/charts/patch_chart.h"
#include "core/refinement/segments/segment_table.h"

namespace remesh {

/// A reference to a patch that is to be refined, as it was triangulated. The object refers to the mesh and to the
/// segment table.
struct PatchToRefine {
  const PatchMesh& mesh;
  PatchChart chart;
  PatchId id;
  const SegmentTable& segments;

  /// Returns the position of a vertex of the mesh.
  const Vec3& position(std::uint32_t v) const { return segments.surface().positions[mesh.vertices[v]]; }
};

}  // namespace remesh
