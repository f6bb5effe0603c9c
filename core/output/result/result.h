/// The result of a run.
#pragma once

#include "core/base/ids.h"
#include "core/mesh/mesh.h"
#include "core/output/report/report.h"
#include "core/output/result/output_basis.h"

namespace remesh {

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
  OutputBasis basis;  ///< the data that round_output needs
};

}  // namespace remesh
