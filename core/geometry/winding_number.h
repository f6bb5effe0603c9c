/// How far a surface with holes is around a point.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/triangle_tree.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The winding numbers of triangles around points: 1 in a closed surface that looks outwards, 0 outside of it, and
/// between the two as much as the triangles cover of all directions.
/// Input:   what is given outlives this; coordinates within [-2^250, 2^250].
/// Holds:   right to some hundredths: triangles far away count as one small face.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) to build, O(log n) for a point, but for places where many triangles are near.
/// Source:  Barill, Dickson, Schmidt, Levin, Jacobson, Fast Winding Numbers for Soups and Clouds, 2018.
class WindingNumber {
 public:
  WindingNumber(std::span<const Vec3> positions, std::span<const Triangle> triangles, RunControl& control);

  double at(const Vec3& p) const;
  /// The box around all triangles.
  const Box3& box() const { return nodes_[0].box; }

 private:
  struct Node {
    Box3 box;
    Vec3 twice_area;         ///< the sum of vectors
    Vec3 moment;             ///< the centroids, each as often as there is area
    double twice_sizes = 0;  ///< the sum of the vectors' lengths
  };
  Node node_of(std::size_t slot) const;
  double solid_angle(std::size_t slot, const Vec3& p) const;

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  RunControl& control_;
  TriangleTree tree_;
  std::vector<Node> nodes_;
};

}  // namespace remesh
