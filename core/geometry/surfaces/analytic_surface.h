/// The surfaces from which CAD programs make the facets of a part, in closed form.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/vec.h"

namespace remesh {

enum class SurfaceKind : std::uint8_t { kPlane, kCylinder, kCone, kSphere, kTorus, kRevolution, kFree };

/// The stable name of a kind.
std::string_view kind_name(SurfaceKind kind);

/// A surface of one of the kinds with a closed formula: a plane, cylinder, cone, sphere or torus. Which members have a
/// meaning depends on the kind. A cone has one half only: the one into which its axis points from the apex.
struct AnalyticSurface {
  SurfaceKind kind = SurfaceKind::kFree;
  /// Plane: a point of it. Cylinder, revolution: a point of the axis. Cone: the apex. Sphere, torus: the centre.
  Vec3 origin;
  /// Plane: the unit normal. Cylinder, cone, torus, revolution: the unit direction of the axis. Sphere: null.
  Vec3 axis;
  /// Cylinder, sphere; for a torus the major radius, from the axis to the middle of the tube. The latter is negative if
  /// the middle of the tube lies beyond the axis, as at an ogive. Where the tube reaches the axis, the torus ends.
  double radius = 0;
  double minor_radius = 0;  ///< torus: the radius of the tube
  double half_angle = 0;    ///< cone: the angle between axis and surface, in radians, between 0 and pi / 2

  /// Returns the distance of a point from the surface. It is positive on the side to which the axis of a plane points,
  /// and otherwise outside of the cylinder, cone, sphere or tube.
  /// Input: the kind is neither kRevolution nor kFree.
  double distance(const Vec3& p) const;
  /// Returns the unit normal of the surface at the point of it that is nearest to `p`, on the side where distances are
  /// positive. It is null where no point is nearest, for example on the axis of a cylinder.
  /// Input: the kind is neither kRevolution nor kFree.
  Vec3 normal(const Vec3& p) const;
  /// Returns the distance of a point from the axis, or from the centre of a sphere.
  double distance_from_axis(const Vec3& p) const;
};

/// Returns whether all numbers of two surfaces are the same.
bool is_same(const AnalyticSurface& a, const AnalyticSurface& b);

/// Returns one of the two directions of an axis that has none of its own: the one in which its largest component is
/// positive. If components are about as large, the first of them counts.
Vec3 canonical_direction(const Vec3& axis);

}  // namespace remesh
