/// Measures faces against a curved surface, with the checker's own formulas. Nothing is sampled: each number bounds the
/// whole face.
#pragma once

#include <span>

#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/verify/model/curved_face.h"

namespace remesh::verification {

/// A point at a cylinder or a cone, relative to the axis.
struct RuledPoint {
  double along = 0;   ///< the place of the surface's nearest point on its ruling, seen from the apex of a cone
  double radius = 0;  ///< distance of the point from the axis
  Vec2 across;        ///< the point's place in the plane across the axis
};

/// A cylinder, cone, sphere or torus in the numbered claim's scale. Distances are positive outside, and normals point
/// there.
class CurvedShape {
 public:
  /// Input:  `claimed` - in model units; `scale` - model units times this give the units used here.
  CurvedShape(const AnalyticSurface& claimed, double scale);

  /// True if the numbers describe a surface: they are finite, the axis is a unit vector, radii are positive.
  bool is_sound() const;
  /// True if the surface is compact, so that it can be covered as a whole.
  bool is_compact() const;
  /// The area of a compact surface.
  double area() const;
  /// The max distance from the surface at which nearest points are used. It is half of the radius of the cylinder,
  /// sphere or tube, and infinite for a cone, where faces are compared with the axis instead.
  double largest_depth() const;
  /// A bound on the rounding of a distance that is computed here.
  double noise() const { return noise_; }

  double distance(const Vec3& p) const;
  /// A bound on the distance from the surface, without its sign, of all points between a and b.
  double depth_between(const Vec3& a, const Vec3& b) const;
  /// The unit normal of the surface at the point of it that is nearest to p; null on the axis.
  Vec3 normal(const Vec3& p) const;
  /// The unit direction around the axis at p; null for a sphere and on the axis.
  Vec3 direction_around(const Vec3& p) const;
  /// The largest distance of the surface from its axis, or from its centre for a sphere; 0 for a cone, which has none.
  double largest_radius() const;
  /// The length of the part of a way along which the surface's normal may turn. Along the axis of a cylinder or a cone
  /// it does not turn.
  double turning_length(const Vec3& way) const;
  /// A bound on the turn of the surface's normal per length of the way of p, if p stays in a ball around the given
  /// centre. At a cylinder or a cone, both are measured across the axis.
  /// Output: infinity if the ball reaches a place that has no nearest point, for example the axis of a cylinder.
  double turn_rate(const Vec3& centre, double radius) const;

  /// True for a cylinder and a cone. The next four functions are for these.
  bool is_ruled() const { return kind_ == SurfaceKind::kCylinder || kind_ == SurfaceKind::kCone; }
  RuledPoint ruled(const Vec3& p) const;
  /// The surface's distance from the axis at a place on a ruling.
  double ruled_radius(double along) const { return kind_ == SurfaceKind::kCylinder ? radius_ : along * sin_; }
  /// The sine and the cosine of the angle between rulings and axis.
  double sine() const { return sin_; }
  double cosine() const { return cos_; }

  /// Measures a flat polygon.
  /// Input:  `corners` - they may be changed; `snap` - corners of a cone's face count as being at the apex if their
  ///         distance from it, times the sine of the half angle, is no more than this; `known` - distances of other
  ///         faces. A torus is measured no finer than these require.
  /// Output: `distance` is exact to rounding, apart from a torus, for which it may exceed both `known` and the true
  ///         range by a 64th of their width. If the corners of a polygon lie off their plane, the range is wider by
  ///         their distance.
  /// Cost:   O(corners). A triangle at a torus is cut into no more than 1,024 pieces.
  CurvedFace read(std::span<Vec3> corners, double snap, const Range& known) const;

 private:
  /// A point relative to the axis: its height along the axis, and its place in the plane across the axis.
  struct Local {
    double height = 0;
    Vec2 across;
    double radius() const;
  };
  Local local(const Vec3& p) const;
  double distance(const Local& p) const;
  double lowest_on_edge(const Local& a, const Local& b) const;
  CurvedFace read_ruled(std::span<const Vec3> corners, const Vec3& normal) const;
  CurvedFace read_sphere(std::span<const Vec3> corners, const Vec3& normal) const;
  CurvedFace read_torus(std::span<const Vec3> corners, const Vec3& normal, const Range& known) const;

  SurfaceKind kind_;
  Vec3 origin_, axis_;
  Vec3 x_, y_;  ///< unit vectors across the axis
  double radius_ = 0, minor_radius_ = 0, half_angle_ = 0;
  double cos_ = 1, sin_ = 0;  ///< of the cone's half angle; a cylinder is treated as a cone of angle 0
  double noise_ = 0;
};

}  // namespace remesh::verification
