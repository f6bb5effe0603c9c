/// Bounds on the angles at which faces lie around a line, for the nodes of a tree. They separate faces that meet in one
/// point or edge of that line.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The line through two vertices. The boxes of all faces at these vertices contain one of the two, and those of
/// neighbouring faces both, so boxes do not separate such faces. The angles about the line under which the faces are
/// seen do, as they separate the pages of a book.
/// Holds:   if two faces are apart and one of them has one of the two vertices, the faces have nothing in common but
///          shared corners and the edge between the two vertices. Rounding never separates faces that meet.
/// Cost:    O(n) to build.
class AxialBounds {
 public:
  /// A range of angles about the line, in turns: from `begin` on, over `length`. A length of 1 or more means all
  /// angles, and a length below 0 means none.
  struct Arc {
    double begin = 0, length = -1;
  };

  /// Input:   the tree must be over these triangles, the line's two vertices must be at different places, and the
  ///          coordinates must be in the range of predicates_3d.h.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  AxialBounds(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces, VertexId from,
              VertexId to, RunControl& control);

  /// The angles under which a face is seen from the line. Corners at the two vertices do not count.
  Arc arc_of(const Triangle& face) const;

  bool are_apart(const Arc& arc, std::size_t node) const;

 private:
  std::span<const Vec3> positions_;
  VertexId from_, to_;
  std::array<Vec3, 2> axes_;  ///< orthonormal, and at right angles to the line, up to rounding
  std::vector<Arc> arcs_;     ///< by node
};

}  // namespace remesh
