/// The result of a run.
#pragma once

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/mesh/mesh.h"
#include "core/output/report/report.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/unrefined.h"
#include "core/verify/claim/claim.h"

namespace remesh {

/// The data about a run that its result needs when an output format rounds the coordinates.
struct RoundingInput {
  IdVector<PatchId, Vec3> normals;            ///< unit normals of the patches' frames
  IdVector<PatchId, std::uint8_t> is_curved;  ///< not 0: the patch is curved; empty if none is
  double allowed_move = 0;                    ///< how far rounding may move a vertex, in model units
  bool is_refined = false;                    ///< there were goals
  Goals goals{.max_edge_length = 0, .max_area = 0, .max_faces = 0};
  UnrefinedFaces unrefined;          ///< the faces of the result that miss the goals
  InputIntersections intersections;  ///< patches that intersect before rounding
  BodyLabels patch_labels;           ///< by patch: the labels of all faces that it stands for
};

/// A verified mesh and its report.
struct Result {
  TriangleMesh mesh;
  IdVector<FaceId, PatchId> face_patch;  ///< one per output face; indexes report.patches
  IdVector<FaceId, FaceId> face_source;  ///< the input face under each face's centroid; empty unless asked for
  /// The patch of each input face, or of its first piece; invalid if the face was dropped. Empty if face_source is.
  IdVector<FaceId, PatchId> input_face_patch;
  Report report;
  /// The storage that it was meant for could not hold it. The coordinates are doubles.
  bool is_not_held = false;
  RoundingInput rounding_input;  ///< the data that round_for_format needs
};

}  // namespace remesh
