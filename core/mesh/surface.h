/// The surface on which the stages after `weld` work.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/coordinate_range.h"
#include "core/base/copy_on_write.h"
#include "core/base/ids.h"
#include "core/base/vec.h"

namespace remesh {

/// Faces that will replace the faces of a surface.
struct FaceList {
  std::vector<std::uint32_t> face_begin{0};
  std::vector<VertexId> corners;
  FilledIdVector<FaceId, FaceId> face_source;
  IdVector<FaceId, std::uint32_t> face_label;  ///< empty if all labels are 0

  std::size_t face_count() const { return face_begin.size() - 1; }
  void add_face(std::span<const VertexId> loop, FaceId source, std::uint32_t label) {
    corners.insert(corners.end(), loop.begin(), loop.end());
    face_begin.push_back(static_cast<std::uint32_t>(corners.size()));
    if (label != 0 && face_label.empty()) face_label.assign(face_source.size(), 0);
    if (label != 0 || !face_label.empty()) face_label.push_back(label);
    face_source.push_back(source);
  }
};

/// Lists the input faces that each face of a surface covers, face after face. It is empty if each covers its source.
struct CoveredFaces {
  std::vector<std::size_t> begin;  ///< where those of each face begin, and the end
  std::vector<FaceId> faces;

  std::span<const FaceId> of(FaceId f) const {
    return std::span(faces).subspan(begin[f.value], begin[f.value + 1] - begin[f.value]);
  }
};

/// Polygons over welded vertices.
/// Holds:   no two positions are equal. Data that did not change still belongs to the mesh from which the surface was
///          made, and that mesh outlives the surface. From mend_faces on, every vertex is used, polygons are planar, no
///          face repeats a corner directly after it, and no face has zero area except those that mend_faces lets pass.
struct Surface {
  CopyOnWrite<VertexId, Vec3> positions;
  /// The positions minus the box's centre, divided by `unit`, which is a power of two. They are within [-1, 1]. The
  /// stages compute with these, so that nothing overflows, and a scaling by powers of two changes nothing.
  FilledIdVector<VertexId, Vec3> local;
  Vec3 centre;      ///< the centre of the bounding box, in model units
  double unit = 1;  ///< model units per local unit
  CopyOnWrite<std::size_t, std::uint32_t> face_begin{std::vector<std::uint32_t>{0}};
  CopyOnWrite<std::size_t, VertexId> corners;
  FilledIdVector<VertexId, VertexId>
      vertex_source;  ///< the first input vertex with these coordinates; for a new vertex, that of a neighbour
  FilledIdVector<FaceId, FaceId> face_source;  ///< the input face from which each face came; ascending
  /// The input faces that each face covers. Empty if each face covers only the face in `face_source`.
  CoveredFaces covers;
  /// One number per face. Between neighbours with different labels is a barrier: they never belong to one patch. Empty
  /// if there are no labels.
  IdVector<FaceId, std::uint32_t> face_label;
  /// The faces that were made to close holes, ascending. Each has the source and the label of a face at its hole's rim.
  std::vector<FaceId> caps;

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t face_count() const { return face_begin.size() - 1; }
  /// Returns the input faces that a face covers.
  std::span<const FaceId> covered(FaceId f) const {
    return covers.begin.empty() ? std::span(face_source.items()).subspan(f.value, 1) : covers.of(f);
  }
  std::uint32_t label(FaceId f) const { return face_label.empty() ? 0 : face_label[f]; }
  std::span<const VertexId> face(FaceId f) const {
    return corners.items().subspan(face_begin[f.value], face_begin[f.value + 1] - face_begin[f.value]);
  }

  /// Converts a place of the model to local units.
  Vec3 to_local(const Vec3& p) const {
    // Coordinates below this count as 0, because predicates must not underflow.
    constexpr double kLeast = CoordinateRange::kNarrowest;
    Vec3 q;
    for (int axis = 0; axis < 3; ++axis) {
      q[axis] = (p[axis] - centre[axis]) / unit;
      if (std::fabs(q[axis]) < kLeast) q[axis] = 0;
    }
    return q;
  }

  /// Calls `take` with each input face from which some of the given faces came. The given faces are ascending. An input
  /// face that was split is passed only once.
  template <class Take>
  void for_each_source(std::span<const FaceId> of_faces, Take take) const {
    FaceId last;
    for (const FaceId f : of_faces)
      if (face_source[f] != last) take(last = face_source[f]);
  }

  /// Replaces the faces by these. The new faces use the surface's own vertices, and none of them closes a hole.
  void take_faces(FaceList&& faces) {
    face_begin = std::move(faces.face_begin);
    corners = std::move(faces.corners);
    face_source = std::move(faces.face_source);
    face_label = std::move(faces.face_label);
    covers = {};
    caps.clear();
  }
  /// Copies all data that still belongs to the mesh from which the surface was made, so that the surface no longer
  /// needs that mesh.
  void detach() {
    positions.detach();
    face_begin.detach();
    corners.detach();
  }
};

}  // namespace remesh
