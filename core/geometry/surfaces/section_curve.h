/// The curves in which a cylinder, cone, sphere or torus meets a plane, where they have a closed formula.
#pragma once

#include <optional>
#include <span>

#include "core/base/vec.h"
#include "core/geometry/planes/plane.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// The curve in which a surface meets a plane: a circle, an ellipse on a cylinder, or any section of a cone. Its points
/// are parametrised by an angle. For a cylinder or cone it is the angle about the axis, and for a circle the angle
/// about its centre. All lengths are in model units.
class SectionCurve {
 public:
  /// Returns the curve of the surface and the plane on which the points lie, or nothing if there is no closed formula
  /// or if some point is not on the curve. The points begin at angle 0.
  /// Input:  the points run along the curve; there are two or more. `fit_tolerance` is the largest distance of a point
  ///         from the surface and from the plane. The kind of the surface is a cylinder, cone, sphere or torus. The
  ///         plane is in model units.
  /// Holds:  points of the curve lie on the surface and in the plane, up to rounding. Where the plane touches the
  ///         surface or nearly does so, the curve is the circle about the axis that fits the points.
  /// Cost:   O(points).
  static std::optional<SectionCurve> through(std::span<const Vec3> points, const AnalyticSurface& surface,
                                             const Plane& plane, double fit_tolerance);

  /// Returns the angle of the point of the curve that is nearest to a point, between -pi and pi. More exactly, it is
  /// the point of the curve in the same half-plane from the axis.
  double angle(const Vec3& p) const;
  /// Returns the point at an angle.
  Vec3 point(double angle) const;

 private:
  static std::optional<SectionCurve> circle(std::span<const Vec3> points, const Vec3& centre, const Vec3& axis,
                                            std::optional<double> radius, double fit_tolerance);
  static std::optional<SectionCurve> ruled(std::span<const Vec3> points, const AnalyticSurface& surface,
                                           const Plane& plane);
  static std::optional<SectionCurve> of_sphere(std::span<const Vec3> points, const AnalyticSurface& sphere,
                                               const Plane& plane, double fit_tolerance);
  static std::optional<SectionCurve> of_torus(std::span<const Vec3> points, const AnalyticSurface& torus,
                                              const Plane& plane, double fit_tolerance);
  static std::optional<SectionCurve> about_axis(std::span<const Vec3> points, const AnalyticSurface& surface,
                                                const Plane& plane, double fit_tolerance);
  bool begin_at(const Vec3& p);

  Vec3 centre_;  ///< the centre of the circle; if the curve is ruled, that of a circle about the axis
  Vec3 axis_;    ///< unit normal of the circle
  Vec3 x_, y_;   ///< unit vectors across the axis; angle 0 is along x
  double radius_ = 0;
  // If the curve is ruled, the point of the circle at an angle is moved along its ruling until it is in the plane.
  bool is_ruled_ = false;
  double half_angle_ = 0;  ///< between axis and rulings
  Vec3 normal_;            ///< unit normal of the plane that cuts the surface
  double offset_ = 0;      ///< distance of the plane from the centre, along its normal
};

}  // namespace remesh
