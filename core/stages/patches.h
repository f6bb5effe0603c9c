/// Numbers the patches: edge-connected pieces of a plane.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/stages/coplanar_regions.h"

namespace remesh {

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

/// Input:  `regions.are_connected` is taken at its word: then each region is a piece.
/// Output: one patch per edge-connected piece of a region, numbered by its first face.
/// Source: the 2018 report, section 3, as amended: connected over edges.
PatchSet patches(const Surface& surface, const Adjacency& adjacency, const Regions& regions, RunControl& control);

/// Whether half-edge h bounds its patch: on its edge there is not exactly one other face, of the same patch, that looks
/// the same way.
inline bool is_patch_boundary(const Adjacency& adjacency, const PatchSet& set, std::uint32_t h) {
  const std::uint32_t twin = adjacency.twin(h);
  return twin == Adjacency::kNone || set.of_face[adjacency.face_of(twin)] != set.of_face[adjacency.face_of(h)];
}

}  // namespace remesh
