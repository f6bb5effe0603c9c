/// What a run gives back.
#pragma once

#include "core/base/ids.h"
#include "core/mesh/mesh.h"
#include "core/output/output_basis.h"
#include "core/output/report.h"

namespace remesh {

/// A verified mesh and what is to be told of it.
struct Result {
  TriangleMesh mesh;
  IdVector<FaceId, PatchId> face_patch;  ///< one per output face; indexes report.patches
  IdVector<FaceId, FaceId> face_source;  ///< the input face under each face's centroid; empty unless asked for
  /// The patch of each input face, or of its first piece; invalid where it was dropped. Empty like face_source.
  IdVector<FaceId, PatchId> input_face_patch;
  Report report;
  OutputBasis basis;  ///< for round_output
};

}  // namespace remesh
