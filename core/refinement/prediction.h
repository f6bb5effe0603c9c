/// How many faces a refinement will make, before it is done.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/refinement/goals.h"
#include "core/refinement/size_field.h"
#include "core/stages/patch_meshing.h"

namespace remesh {

struct Prediction {
  /// No result that meets the size goals has fewer: patch areas over the largest triangle that is allowed, and the
  /// pieces into which boundaries must be cut, one triangle each.
  double least = 0;
  /// What to expect: by sizes within some 30 %, by angles alone within a factor of two or so, along narrow strips too
  /// (fans of needles have no cheap tight estimate).
  double expected = 0;
  /// One per patch, at least 1: its share in that, but for what it makes of cuts that others need.
  std::vector<float> of_patch;
};

/// Input:  triangulated patches over the vertices that stay.
/// Cost:   O(n), with sizes that vary O(n log n).
Prediction predict(const std::vector<PatchMesh>& meshes, const Goals& goals, const SizeField& sizes,
                   RunControl& control);

}  // namespace remesh
