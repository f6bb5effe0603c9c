/// The chart of a curved patch.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/vec.h"
#include "core/geometry/surfaces/surface_map.h"
#include "core/patches/charts/curved_patches.h"

namespace remesh {

/// A vertex of a curved patch in space, in model units.
struct SpacePoint {
  Vec3 position;
  Vec3 normal;  ///< of the surface at its point that is nearest; null at the apex of a cone, which has none
  bool is_near_apex = false;    ///< there, edges that turn by a sixth of a circle are within the tolerance
  bool is_beside_apex = false;  ///< there, edges that turn by a third of a circle are within the tolerance
};

/// A map of a curved patch, and how coarse the patch may become.
class CurvedChart {
 public:
  /// A triangle of a ball is deeper in its middle than at its edges. With acute angles, its circumradius is at most its
  /// longest edge over the root of 3, instead of half of that edge, so its depth is at most 4/3 of that of its edges.
  static constexpr double kDepthOfEdges = 0.75;

  CurvedChart() = default;
  explicit CurvedChart(const CurvedPatch& patch);

  const SurfaceMap& map() const { return map_; }
  /// The middle of the patch in the map's plane.
  Vec2 middle;

  /// Returns the distance of a point from the surface, positive on the facets' outside.
  double height(const Vec3& position) const { return map_.side() * map_.shape().distance(position); }
  SpacePoint space_point(const Vec3& position) const;
  /// Returns the largest angle by which the surface may turn along an edge, in radians.
  double max_turn() const { return 2 * std::asin(std::min(1.0, std::sqrt(max_turn_squared_) / 2)); }
  /// Returns the largest depth of an edge below the surface, in model units.
  double max_edge_height() const { return max_edge_height_; }
  /// Returns whether the surface turns too far along an edge, or the edge lies too deep below it.
  bool is_bent(const SpacePoint& a, const SpacePoint& b) const;
  /// Returns whether a triangle whose edges are not bent lies too deep below its surface in the middle. Only on spheres
  /// and tori is the middle deeper than the edges.
  bool is_deep(const Vec3& a, const Vec3& b, const Vec3& c) const;

 private:
  SurfaceMap map_;
  double max_height_ = 0;        ///< of faces
  double max_edge_height_ = 0;   ///< of edges; less on spheres and tori
  double max_turn_squared_ = 0;  ///< the square of the distance of two unit normals that are the largest turn apart
  double max_turn_squared_at_apex_ = 0;  ///< the same for edges beside the apex of a cone
};

}  // namespace remesh
