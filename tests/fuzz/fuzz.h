/// Checks that the fuzz targets share.
#pragma once

#include <cstdlib>
#include <iostream>
#include <string_view>

#include "core/base/error.h"
#include "core/mesh/mesh.h"

namespace remesh::fuzz {

/// Ends the run with a finding.
[[noreturn]] inline void found(std::string_view what) {
  std::cerr << "FOUND: " << what << "\n";
  std::abort();
}

inline void require(bool condition, std::string_view what) {
  if (!condition) found(what);
}

/// Requires everything that PolygonMesh promises.
inline void check_mesh(const PolygonMesh& mesh) {
  require(mesh.face_count() > 0, "a reader gives a mesh without faces");
  require(mesh.face_begin.front() == 0 && mesh.face_begin.back() == mesh.corners.size(), "face_begin is not whole");
  for (std::size_t f = 0; f < mesh.face_count(); ++f) {
    require(mesh.face_begin[f] + 3 <= mesh.face_begin[f + 1], "a face has fewer than three corners");
  }
  for (const VertexId v : mesh.corners) require(v.value < mesh.vertex_count(), "a corner is no vertex");
  for (const Vec3& p : mesh.positions) require(is_finite(p), "a coordinate is not finite");
  for (const LabelSet* set : {&mesh.labels.object, &mesh.labels.group, &mesh.labels.material}) {
    if (!set->is_used()) continue;
    require(set->of_face.size() == mesh.face_count(), "labels are not one a face");
    for (const std::uint32_t label : set->of_face) require(label < set->names.size(), "a label has no name");
  }
}

/// An error of reading is one that the contract has for it, and says where, if anything is there.
inline void check_error(const Error& error) {
  switch (error.code) {
    case Code::kInvalidMesh:
    case Code::kIndexOutOfRange:
    case Code::kNonfiniteCoordinate:
      require(error.line || error.byte || error.element, "an error does not say where");
      return;
    case Code::kEmptyMesh:
    case Code::kMeshTooLarge:
    case Code::kDecompressedTooLarge: return;
    default: found(error.what());
  }
}

}  // namespace remesh::fuzz
