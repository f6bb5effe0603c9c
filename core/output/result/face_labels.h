/// The labels of a result's faces, and the input faces from which they came.
#pragma once

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// Returns whether the source of each face must be known to label it. If every label is a barrier, all faces of a patch
/// have the same labels, so any of them will do.
bool do_labels_need_sources(const FaceLabels& labels, const Barriers& barriers);

/// Returns, for each output face, the first input face of its patch.
IdVector<FaceId, FaceId> first_faces(const Surface& surface, const PatchSet& patches,
                                     const IdVector<FaceId, PatchId>& face_patch);

/// The patch of each input face, or that of its first piece; invalid if the face was dropped. `input_faces` is the
/// number of input faces.
IdVector<FaceId, PatchId> patches_of_input(const Surface& surface, const PatchSet& patches, std::size_t input_faces);

/// The labels of faces, given the input face from which each came.
FaceLabels labels_from(const FaceLabels& input, const IdVector<FaceId, FaceId>& source);

}  // namespace remesh
