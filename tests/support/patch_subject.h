/// Prepares a patch of a small mesh so that a test can refine it alone.
#pragma once

#include <cstdint>
#include <vector>

#include "core/refinement/goals/goals.h"
#include "core/refinement/refiner/patch_to_refine.h"
#include "core/refinement/segments/segment_cuts.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/criteria.h"
#include "core/refinement/sizes/size_field.h"
#include "tests/support/stage_chain.h"

namespace remesh {

/// The patches of a mesh with the segments between them, and the cuts that sizes alone ask for. Sizes are uniform.
struct PatchSubject {
  explicit PatchSubject(const PolygonMesh& mesh, const Options& options = {})
      : chain(mesh),
        goals(goals_of(options, 1)),
        sizes(goals.max_edge_length),
        criteria(goals, sizes),
        table(chain.surface, chain.triangulated, IdVector<PatchId, std::uint8_t>(chain.meshes.size()), sizes, goals,
              chain.control),
        cuts(table.size()) {
    table.plan_cuts(chain.triangulated, sizes, goals, chain.control);
    for (std::uint32_t s = 0; s < table.size(); ++s) cuts[SegmentId(s)] = table.size_cuts(SegmentId(s), sizes);
  }

  PatchToRefine patch(PatchId p = PatchId(0)) const { return {chain.meshes[p], chain.charts()[p], p, table}; }
  PatchChart chart() const { return chain.charts()[PatchId(0)]; }

  StageChain chain;
  Goals goals;
  SizeField sizes;
  Criteria criteria;
  SegmentTable table;
  SegmentCuts::OfSegments cuts;
};

}  // namespace remesh
