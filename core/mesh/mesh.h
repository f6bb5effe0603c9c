/// Meshes as flat arrays: polygons on the way in, triangles on the way out.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"

namespace remesh {

/// The names of one kind of label (object, group or material), and the index of each face's name.
struct LabelSet {
  std::vector<std::string> names;
  /// One index into `names` per face, or empty if the mesh has no label of this kind.
  IdVector<FaceId, std::uint32_t> of_face;

  bool is_used() const { return !of_face.empty(); }
  friend bool operator==(const LabelSet&, const LabelSet&) = default;
};

/// The labels that a face has besides its patch. All three kinds are passed on to the output's faces.
struct FaceLabels {
  LabelSet object;
  LabelSet group;
  LabelSet material;
  /// The files that `mtllib` records name, in order. They are never opened.
  std::vector<std::string> material_libraries;

  friend bool operator==(const FaceLabels&, const FaceLabels&) = default;
};

/// A surface as it was read. Its polygons may have any size, and its vertices are those of the file.
/// Holds: face_begin has one entry more than there are faces, starts at 0, ends at corners.size(); every face has
///        3 or more corners; every corner is a valid vertex; every coordinate is finite.
struct PolygonMesh {
  /// `face_begin` counts corners in 32 bits.
  static constexpr std::uint64_t kMaxCorners = std::numeric_limits<std::uint32_t>::max();

  IdVector<VertexId, Vec3> positions;
  std::vector<std::uint32_t> face_begin{0};
  std::vector<VertexId> corners;
  FaceLabels labels;

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t face_count() const { return face_begin.size() - 1; }
  std::span<const VertexId> face(FaceId f) const {
    return std::span(corners).subspan(face_begin[f.value], face_begin[f.value + 1] - face_begin[f.value]);
  }
};

using Triangle = std::array<VertexId, 3>;

/// A triangulated surface. Its faces are counter-clockwise seen from outside.
struct TriangleMesh {
  IdVector<VertexId, Vec3> positions;
  IdVector<FaceId, Triangle> faces;
  FaceLabels labels;
};

}  // namespace remesh
