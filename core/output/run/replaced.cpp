#include "core/output/run/replaced.h"

#include <algorithm>
#include <utility>

#include "core/base/stoppable.h"
#include "core/mesh/face_marks.h"

namespace remesh {

bool are_different(std::vector<Vec3> places, const RunControl& control) {
  sort_stoppable(places.begin(), places.end(), control);
  return std::adjacent_find(places.begin(), places.end()) == places.end();
}

CoveredFaces covers_of_new_faces(const Surface& before, const PatchSet& patches, const IdVector<FaceId, PatchId>& patch,
                                 const FilledIdVector<FaceId, FaceId>& source) {
  CoveredFaces covers;
  covers.begin.push_back(0);
  std::vector<std::uint8_t> is_found(patches.count(), 0);
  for (FaceId f(0); f.value < patch.size(); ++f.value) {
    if (std::exchange(is_found[patch[f].value], 1) == 0) {
      const std::vector<FaceId> covered = covered_by(before, patches.faces_of(patch[f]));
      covers.faces.insert(covers.faces.end(), covered.begin(), covered.end());
    } else {
      covers.faces.push_back(source[f]);
    }
    covers.begin.push_back(covers.faces.size());
  }
  return covers;
}

}  // namespace remesh
