/// Represents the object, group and material of each face as one number.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/geometry/shells/shells.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// Numbers the combinations of those labels that are barriers, in the order of their first use.
/// Output:  one number per face; empty if no barrier is used.
IdVector<FaceId, std::uint32_t> number_labels(const FaceLabels& labels, const Barriers& barriers, std::size_t faces,
                                              RunControl& control);

/// The labels of faces, each of which came from one input face. Labels that are no barriers count, too.
/// Cost:    O(n log k) for k combinations of labels. Neighbours in the input have few.
BodyLabels labels_of_sources(const FaceLabels& labels, std::span<const FaceId> source, RunControl& control);

/// The labels of patches. A patch has the labels of all its faces, so the shells of a result have the labels that they
/// had in the surface, even if labels do not bound patches.
/// Output:  one set per patch.
/// Cost:    as above.
BodyLabels labels_of_patches(const FaceLabels& labels, const Surface& surface, const PatchSet& patches,
                             RunControl& control);

/// The labels of a result's faces, which are those of their patches.
/// Input:   `face_patch` is the patch of each face.
BodyLabels labels_of_result(const BodyLabels& of_patches, std::span<const PatchId> face_patch, RunControl& control);

}  // namespace remesh
