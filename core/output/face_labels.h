/// The labels of a result's faces, and where they came from.
#pragma once

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Whether the source of each face must be known to label it. Where every label is a barrier, all faces of a patch are
/// labelled alike, and any of them tells.
bool do_labels_need_sources(const FaceLabels& labels, const Barriers& barriers);

/// For each output face the first input face of its patch.
IdVector<FaceId, FaceId> first_faces(const Surface& surface, const PatchSet& patches,
                                     const IdVector<FaceId, PatchId>& face_patch);

/// The patch of each of `input_faces` faces, or that of its first piece; invalid where it was dropped.
IdVector<FaceId, PatchId> patches_of_input(const Surface& surface, const PatchSet& patches, std::size_t input_faces);

/// The labels of faces that came from these faces of the input.
FaceLabels labels_from(const FaceLabels& input, const IdVector<FaceId, FaceId>& source);

}  // namespace remesh
