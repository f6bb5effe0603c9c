/// The input of a refinement.
#pragma once

#include <cstdint>

#include "core/base/ids.h"
#include "core/mesh/surface.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/thinning.h"
#include "core/refinement/prediction/prediction.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// The input of a refinement. It refers to these objects.
struct RefinementInput {
  const Surface& surface;
  /// There is one entry per patch. Frozen patches get no points, neither inside nor on their boundaries.
  const IdVector<PatchId, std::uint8_t>& is_frozen;
  const Goals& goals;  ///< `max_faces` is the budget
  const SizeField& sizes;
  const Prediction& prediction;  ///< used for the progress, and for sharing out a budget at first
  /// Refinement ends as soon as it is clear that there will at some time be more triangles than this.
  std::uint64_t max_made;
  /// Tells how patches are thinned out where the budget ends refinement before the goals are met.
  Thinning thinning_in_budget = Thinning::kFull;
};

}  // namespace remesh
