/// Surfaces in the tests' own terms, with formulas of their own. Recognition is judged by these, so that a fault of the
/// core's formulas cannot hide itself.
#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh::test {

/// A surface of any kind but kFree, which has neither points nor a normal.
struct PlainSurface {
  SurfaceKind kind = SurfaceKind::kFree;
  Vec3 point;  ///< plane: a point of it; cylinder, revolution: a point of the axis; cone: the apex; else the centre
  Vec3 axis;   ///< plane: its normal; cone: into its half; any length but 0; unused for a sphere
  double radius = 0;          ///< cylinder, sphere; torus: from the centre to the middle of the tube
  double tube = 0;            ///< torus: the radius of the tube
  double half_deg = 0;        ///< cone: the angle between axis and surface
  std::vector<Vec2> profile;  ///< revolution: (distance from the axis, height over `point`)

  /// Returns the point of the surface that is nearest to `p`, or one of them.
  Vec3 nearest(const Vec3& p) const;
  /// Returns the distance of a point, which is never negative.
  double distance(const Vec3& p) const { return norm(p - nearest(p)); }
  /// Returns a unit normal at the point of the surface that is nearest to `p`, on either side.
  Vec3 normal(const Vec3& p) const;
};

/// Returns what was claimed, as a plain surface.
PlainSurface plain(const RecognisedSurface& surface);

/// Returns the angle in degrees around `axis` through `point` that some points cover: a full turn less the largest gap.
/// It is 0 if there are no points away from the axis.
double covered_turn_deg(const Vec3& point, const Vec3& axis, std::span<const Vec3> points);
/// Returns the angle in degrees that angles in degrees cover on a circle: a full turn less the largest gap.
double covered_turn_deg(std::vector<double> degrees);

/// How much of a surface some of its points cover, in degrees. A small arc tells little about the radius.
struct Arcs {
  double turn = 0;  ///< around the axis; for a sphere, the angle of the narrowest cone that holds them, about
  double tube = 0;  ///< torus: around the tube
};
Arcs arcs_of(const PlainSurface& surface, std::span<const Vec3> points);

/// Returns two unit vectors that make a right-handed frame with the direction `axis`.
struct Across {
  Vec3 x;
  Vec3 y;
};
Across across(const Vec3& axis);

}  // namespace remesh::test
