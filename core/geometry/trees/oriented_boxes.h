/// Boxes that are aligned with the triangles in them, for the nodes of a tree. They separate triangles that lie askew
/// to the axes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Boxes aligned with the triangles of each node of a tree.
/// Holds:   rounding never separates triangles that meet. Triangles nearer to each other than 2^-40 of the largest
///          coordinate may count as meeting.
/// Cost:    O(n log n) to build, in parallel. This is some ten times as much as for the tree, so it is for searches
///          that need it.
/// Source:  Gottschalk, Lin, Manocha, OBBTree, 1996: the axes of the covariance, and the axes that can separate two
///          boxes; here a box and a triangle. Freeman, Shapira, 1975: the smallest rectangle has a side on the convex
///          hull's.
class OrientedBoxes {
 public:
  /// Input:   the tree must be over these triangles. Triangles nearer to each other than `margin` count as meeting,
  ///          too.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  OrientedBoxes(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces,
                double margin, RunControl& control);

  /// A triangle that is tested against nodes.
  struct Query {
    std::array<Vec3, 3> corners, edges;
    Vec3 normal;  ///< its length is arbitrary
  };
  Query query(const Triangle& face) const;

  /// If this is true, no triangle of the node meets this one.
  bool are_apart(const Query& triangle, std::size_t node) const;

 private:
  struct Box {
    Vec3 centre;
    std::array<Vec3, 3> axes;         ///< orthonormal up to rounding
    std::array<double, 3> extents{};  ///< half of the box's length along each axis
  };
  Box box_of(const TriangleTree& tree, std::size_t node, std::span<const Triangle> faces, RunControl& control) const;

  std::span<const Vec3> positions_;
  double margin_;
  std::vector<Box> boxes_;  ///< by node
};

}  // namespace remesh
