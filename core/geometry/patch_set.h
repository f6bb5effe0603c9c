/// Which patch each face is of, and the planes of patches.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/plane.h"
#include "core/mesh/adjacency.h"

namespace remesh {

/// The edge-connected pieces of planes.
struct PatchSet {
  FilledIdVector<FaceId, PatchId> of_face;
  IdVector<PatchId, Plane> planes;               ///< local units
  IdVector<PatchId, double> deviation;           ///< of its region's farthest corner from the plane
  std::vector<std::uint32_t> face_begin{0};      ///< faces of patch p: faces[face_begin[p] .. face_begin[p + 1])
  std::vector<FaceId, LeftUnset<FaceId>> faces;  ///< ascending within a patch

  std::size_t count() const { return planes.size(); }
  std::span<const FaceId> faces_of(PatchId p) const {
    return std::span(faces).subspan(face_begin[p.value], face_begin[p.value + 1] - face_begin[p.value]);
  }
};

/// Whether half-edge h bounds its patch: on its edge there is not exactly one other face, of the same patch, that looks
/// the same way.
inline bool is_patch_boundary(const Adjacency& adjacency, const PatchSet& set, std::uint32_t h) {
  const std::uint32_t twin = adjacency.twin(h);
  return twin == Adjacency::kNone || set.of_face[adjacency.face_of(twin)] != set.of_face[adjacency.face_of(h)];
}

}  // namespace remesh
