/// Boxes along the triangles in them, for the nodes of a tree: they tell apart what lies askew to the axes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangle_tree.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Holds:   rounding never sets apart what meets; what is nearer than 2^-40 of the largest coordinate may count as met.
/// Cost:    O(n log n) to build, in parallel, some ten times as much as the tree: for searches that need it.
/// Source:  Gottschalk, Lin, Manocha, OBBTree, 1996: axes of the covariance, and what sets two boxes apart; here a box
///          and a triangle. Freeman, Shapira, 1975: the least rectangle has a side on the convex hull's.
class OrientedBoxes {
 public:
  /// Input:   the tree over these triangles; what is nearer than `margin` counts as met, too.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  OrientedBoxes(const TriangleTree& tree, std::span<const Vec3> positions, std::span<const Triangle> faces,
                double margin, RunControl& control);

  /// A triangle that is held against nodes.
  struct Query {
    std::array<Vec3, 3> corners, edges;
    Vec3 normal;  ///< of any length
  };
  Query query(const Triangle& face) const;

  /// True: no triangle of the node meets this one.
  bool are_apart(const Query& triangle, std::size_t node) const;

 private:
  struct Box {
    Vec3 centre;
    std::array<Vec3, 3> axes;         ///< orthonormal but for rounding
    std::array<double, 3> extents{};  ///< half of it along each axis
  };
  Box box_of(const TriangleTree& tree, std::size_t node, std::span<const Triangle> faces, RunControl& control) const;

  std::span<const Vec3> positions_;
  double margin_;
  std::vector<Box> boxes_;  ///< by node
};

}  // namespace remesh
