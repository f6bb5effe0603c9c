/// Measures how far a surface that may have holes winds around a point.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/triangle_tree.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The solid angle of a triangle as seen from a point. It is positive if the triangle is seen from behind.
/// Source: van Oosterom, Strackee, The Solid Angle of a Plane Triangle, 1983.
double solid_angle(const Corners3& triangle, const Vec3& p);

/// The winding number of triangles around points. It is 1 inside a closed surface that faces outwards, and 0 outside of
/// it. Around an open surface it is the part of all directions that the triangles cover.
/// Input:   the arguments must outlive this object; coordinates within [-2^250, 2^250].
/// Holds:   around one surface, results are right up to some hundredths, because triangles far away count as one small
///          face. Among thousands of shells that overlap, one result in thousands is off by a quarter.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) to build, and O(log n) for a point, unless many triangles are near it.
/// Source:  Barill, Dickson, Schmidt, Levin, Jacobson, Fast Winding Numbers for Soups and Clouds, 2018.
class WindingNumber {
 public:
  WindingNumber(std::span<const Vec3> positions, std::span<const Triangle> triangles, RunControl& control);

  /// Input:  triangles count as one small face if they are at least `far` times their own radius away. The error falls
  ///         as `far` grows.
  double at(const Vec3& p, double far = 2) const;
  /// The box around all triangles.
  const Box3& box() const { return nodes_[0].box; }

 private:
  struct Node {
    Box3 box;
    Vec3 twice_area;         ///< the sum of the triangles' area vectors, doubled
    Vec3 moment;             ///< the sum of the triangles' centroids, weighted by area
    double twice_sizes = 0;  ///< the sum of the lengths of these area vectors, doubled
  };
  Node node_of(std::size_t slot) const;

  std::span<const Vec3> positions_;
  std::span<const Triangle> triangles_;
  RunControl& control_;
  TriangleTree tree_;
  std::vector<Node> nodes_;
};

}  // namespace remesh
