/// What a result still needs to know of its run when an output format rounds its coordinates.
#pragma once

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/geometry/shells.h"
#include "core/refinement/goals.h"
#include "core/refinement/unrefined.h"
#include "core/verify/verify.h"

namespace remesh {

struct OutputBasis {
  IdVector<PatchId, Vec3> normals;  ///< unit, of the patches' frames
  double allowed_move = 0;          ///< of a vertex, by rounding; model units
  bool is_refined = false;          ///< there were goals
  Goals goals{.max_edge_length = 0, .max_area = 0, .max_faces = 0};
  UnrefinedFaces unrefined;          ///< of the result's faces, those that miss the goals
  InputIntersections intersections;  ///< patches that intersect before anything is rounded
  BodyLabels patch_labels;           ///< by patch: those of all faces that it stands for
};

}  // namespace remesh
