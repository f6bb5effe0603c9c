/// The patches of a surface: which patch each face belongs to, and the patches' planes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/planes/plane.h"
#include "core/mesh/adjacency.h"

namespace remesh {

/// The patches of a surface. They are the edge-connected pieces of its regions.
struct PatchSet {
  FilledIdVector<FaceId, PatchId> of_face;
  IdVector<PatchId, Plane> planes;           ///< in local units
  IdVector<PatchId, double> deviation;       ///< distance of the region's farthest corner from the plane
  std::vector<std::uint32_t> face_begin{0};  ///< the faces of patch p are faces[face_begin[p] .. face_begin[p + 1])
  std::vector<FaceId, DefaultInit<FaceId>> faces;  ///< ascending within a patch

  std::size_t count() const { return planes.size(); }
  std::span<const FaceId> faces_of(PatchId p) const {
    return std::span(faces).subspan(face_begin[p.value], face_begin[p.value + 1] - face_begin[p.value]);
  }
};

/// Returns whether half-edge h bounds its patch. It does unless its edge has exactly one other face, and that face
/// belongs to the same patch and has the same orientation.
inline bool is_patch_boundary(const Adjacency& adjacency, const PatchSet& set, std::uint32_t h) {
  const std::uint32_t twin = adjacency.twin(h);
  return twin == kNone || set.of_face[adjacency.face_of(twin)] != set.of_face[adjacency.face_of(h)];
}

}  // namespace remesh
