/// The distance from a point to the nearest one of some triangles. It has formulas and a tree of its own, so that a
/// fault of the core's cannot hide itself.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"

namespace remesh::recognition {

using PlainTriangle = std::array<Vec3, 3>;

/// Returns the distance of a point from a triangle, which may have no area.
double distance_to(const PlainTriangle& triangle, const Vec3& p);

/// Triangles in a tree of boxes.
class TriangleBoxes {
 public:
  explicit TriangleBoxes(std::vector<PlainTriangle> triangles);
  /// Returns the distance of a point from the nearest triangle. It is infinite if there is none.
  double distance(const Vec3& p) const;

 private:
  struct Node {
    Vec3 low, high;
    std::uint32_t begin = 0, end = 0;
    std::uint32_t second = 0;  ///< the second child, which is 0 for a leaf; the first one follows its parent
  };

  std::vector<PlainTriangle> triangles_;
  std::vector<Node> nodes_;
};

}  // namespace remesh::recognition
