#include "core/output/result/face_labels.h"

namespace remesh {

bool do_labels_need_sources(const FaceLabels& labels, const Barriers& barriers) {
  return (labels.object.is_used() && !barriers.object) || (labels.group.is_used() && !barriers.group) ||
         (labels.material.is_used() && !barriers.material);
}

IdVector<FaceId, FaceId> first_faces(const Surface& surface, const PatchSet& patches,
                                     const IdVector<FaceId, PatchId>& face_patch) {
  IdVector<FaceId, FaceId> source;
  source.reserve(face_patch.size());
  for (const PatchId p : face_patch) source.push_back(surface.face_source[patches.faces_of(p)[0]]);
  return source;
}

IdVector<FaceId, PatchId> patches_of_input(const Surface& surface, const PatchSet& patches, std::size_t input_faces) {
  IdVector<FaceId, PatchId> patch(input_faces);
  for (std::size_t f = surface.face_count(); f-- > 0;)
    for (const FaceId source : surface.covered(FaceId(f))) patch[source] = patches.of_face[FaceId(f)];
  return patch;
}

FaceLabels labels_from(const FaceLabels& input, const IdVector<FaceId, FaceId>& source) {
  FaceLabels out = input;
  for (const auto set : {&FaceLabels::object, &FaceLabels::group, &FaceLabels::material}) {
    if (!(input.*set).is_used()) continue;
    (out.*set).of_face.clear();
    (out.*set).of_face.reserve(source.size());
    for (const FaceId f : source) (out.*set).of_face.push_back((input.*set).of_face[f]);
  }
  return out;
}

}  // namespace remesh
