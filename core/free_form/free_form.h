/// A surface that has no formula.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A surface that may become coarser.
struct FreeForm {
  /// All of them have a face. They are in local units, so between -1 and 1.
  const IdVector<VertexId, Vec3>& positions;
  const IdVector<FaceId, Triangle>& faces;
  /// The half-edge (3 * face + corner) on the other side of each half-edge; kNone where an edge has not exactly two
  /// faces that run along it in opposite directions.
  std::span<const std::uint32_t> twins;
  /// Per half-edge: the kind of its edge, which is the same for both half-edges.
  enum class Edge : std::uint8_t {
    kSmooth,
    kFeature,  ///< stays, unless it says nothing about the shape: see drop_minor_features
    kBorder    ///< stays, as borders of labels do
  };
  std::span<const Edge> edges;
  /// The share of the tolerance that counts at each face, in (0, 1]; empty if all shares are 1.
  std::span<const float> shares = {};
  /// Per face: whether it is a part of a plane, which stays exactly where it is. Such a face only gets other corners
  /// along the border of the plane. Empty if there are none. Edges between them and other faces are borders.
  std::span<const std::uint8_t> is_of_plane = {};
  /// Per vertex: whether it stays. Empty if any may go.
  std::span<const std::uint8_t> is_held = {};
};

}  // namespace remesh
