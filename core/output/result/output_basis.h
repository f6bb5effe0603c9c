/// The data about a run that its result needs when an output format rounds the coordinates.
#pragma once

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/unrefined.h"
#include "core/verify/claim/claim.h"

namespace remesh {

struct OutputBasis {
  IdVector<PatchId, Vec3> normals;            ///< unit normals of the patches' frames
  IdVector<PatchId, std::uint8_t> is_curved;  ///< not 0: the patch is curved; empty if none is
  double allowed_move = 0;                    ///< how far rounding may move a vertex, in model units
  bool is_refined = false;                    ///< there were goals
  Goals goals{.max_edge_length = 0, .max_area = 0, .max_faces = 0};
  UnrefinedFaces unrefined;          ///< the faces of the result that miss the goals
  InputIntersections intersections;  ///< patches that intersect before rounding
  BodyLabels patch_labels;           ///< by patch: the labels of all faces that it stands for
};

}  // namespace remesh
