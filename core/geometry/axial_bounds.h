/// How faces lie around a line, for the nodes of a tree: it tells apart what meets in one point or edge of that line.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangle_tree.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The line through two vertices. All boxes of faces there hold one of them, and those of faces side by side both; the
/// angles about the line under which they are seen tell them apart, as the pages of a book.
/// Holds:   two faces that are apart, of which one has one of the two vertices, have nothing in common but shared
///          corners and the edge between the two. Rounding never sets apart what meets.
/// Cost:    O(n) to build.
class AxialBounds {
 public:
  /// Angles about the line, in turns: from `begin` on, over `length`; everything: 1 or more, nothing: below 0.
  struct Arc {
    double begin = 0, length = -1;
  };

  /// Input:   the tree over these triangles; the line's vertices are at different places; coordinates in the range of
  ///          predicates_3d.h.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  AxialBounds(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces, VertexId from,
              VertexId to, RunControl& control);

  /// The angles under which a face is seen, but for the two vertices.
  Arc arc_of(const Triangle& face) const;

  bool are_apart(const Arc& arc, std::size_t node) const;

 private:
  std::span<const Vec3> positions_;
  VertexId from_, to_;
  std::array<Vec3, 2> axes_;  ///< orthonormal, and to the line, but for rounding
  std::vector<Arc> arcs_;     ///< by node
};

}  // namespace remesh
