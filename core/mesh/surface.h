/// The working surface: what the stages after `weld` see.
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

/// Faces to put into a surface in place of its own.
struct FaceList {
  std::vector<std::uint32_t> face_begin{0};
  std::vector<VertexId> corners;
  FilledIdVector<FaceId, FaceId> face_source;
  IdVector<FaceId, std::uint32_t> face_label;  ///< empty: all 0

  std::size_t face_count() const { return face_begin.size() - 1; }
  void add_face(std::span<const VertexId> loop, FaceId source, std::uint32_t label) {
    corners.insert(corners.end(), loop.begin(), loop.end());
    face_begin.push_back(static_cast<std::uint32_t>(corners.size()));
    if (label != 0 && face_label.empty()) face_label.assign(face_source.size(), 0);
    if (label != 0 || !face_label.empty()) face_label.push_back(label);
    face_source.push_back(source);
  }
};

/// Polygons over welded vertices.
/// Holds:   positions are pairwise different. What is as it was in the mesh that it was made from is still that one's,
///          which outlives it. From mend_faces on: every vertex is used, polygons are planar, no face has a repeated
///          consecutive corner, and none zero area but those that mend_faces keeps.
struct Surface {
  CopyOnWrite<VertexId, Vec3> positions;
  /// The positions less the box's centre, over `unit`, a power of two: within [-1, 1]. The stages compute in these, so
  /// that nothing overflows and scaling by powers of two changes nothing.
  FilledIdVector<VertexId, Vec3> local;
  Vec3 centre;      ///< of the box, model units
  double unit = 1;  ///< model units per local unit
  CopyOnWrite<std::size_t, std::uint32_t> face_begin{std::vector<std::uint32_t>{0}};
  CopyOnWrite<std::size_t, VertexId> corners;
  FilledIdVector<VertexId, VertexId>
      vertex_source;  ///< the first input vertex with these coordinates; of a new one, a neighbour's
  FilledIdVector<FaceId, FaceId> face_source;  ///< the input face this one came from; ascending
  IdVector<FaceId, std::uint32_t> face_label;  ///< equal numbers: no barrier between the faces; empty: none at all

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t face_count() const { return face_begin.size() - 1; }
  std::uint32_t label(FaceId f) const { return face_label.empty() ? 0 : face_label[f]; }
  std::span<const VertexId> face(FaceId f) const {
    return corners.items().subspan(face_begin[f.value], face_begin[f.value + 1] - face_begin[f.value]);
  }

  /// A place of the model in local units.
  Vec3 to_local(const Vec3& p) const {
    // Below this, coordinates count as 0: predicates must not underflow.
    constexpr double kLeast = CoordinateRange::kNarrowest;
    Vec3 q;
    for (int axis = 0; axis < 3; ++axis) {
      q[axis] = (p[axis] - centre[axis]) / unit;
      if (std::fabs(q[axis]) < kLeast) q[axis] = 0;
    }
    return q;
  }

  /// Calls `take` with the input faces that some faces, ascending, came from: with each once, however it was split.
  template <class Take>
  void for_each_source(std::span<const FaceId> of_faces, Take take) const {
    FaceId last;
    for (const FaceId f : of_faces)
      if (face_source[f] != last) take(last = face_source[f]);
  }

  /// Has these faces, over its own vertices, from now on.
  void take_faces(FaceList&& faces) {
    face_begin = std::move(faces.face_begin);
    corners = std::move(faces.corners);
    face_source = std::move(faces.face_source);
    face_label = std::move(faces.face_label);
  }
  /// Looks into the mesh that it was made from no more.
  void detach() {
    positions.detach();
    face_begin.detach();
    corners.detach();
  }
};

}  // namespace remesh
