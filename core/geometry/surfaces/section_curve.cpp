#include "core/geometry/surfaces/section_curve.h"

#include <cmath>

namespace remesh {
namespace {

/// Smallest sine of the angle between a plane and a ruling for which the place where they meet is computed from both.
/// Below it, a small error of the plane moves the place far along the ruling.
constexpr double kMinSlope = 0.1;

/// A section of a sphere or of a torus's tube farther from its middle than this part of the radius is so near to
/// touching that its radius is not computed from the distance of the plane, but from the points.
constexpr double kNearTouching = 0.95;

double distance_from_axis(const Vec3& p, const Vec3& centre, const Vec3& axis) {
  const Vec3 from_centre = p - centre;
  return norm(from_centre - dot(from_centre, axis) * axis);
}

/// The radius of a circle that is cut from a ball at a distance from its middle.
double cut_radius(double radius, double distance) { return std::sqrt((radius - distance) * (radius + distance)); }

}  // namespace

std::optional<SectionCurve> SectionCurve::through(std::span<const Vec3> points, const AnalyticSurface& surface,
                                                  const Plane& plane, double fit_tolerance) {
  for (const Vec3& p : points)
    if (!(std::fabs(surface.distance(p)) <= fit_tolerance) || !(std::fabs(plane.distance(p)) <= fit_tolerance))
      return {};
  switch (surface.kind) {
    case SurfaceKind::kSphere: return of_sphere(points, surface, plane, fit_tolerance);
    case SurfaceKind::kTorus: return of_torus(points, surface, plane, fit_tolerance);
    case SurfaceKind::kCylinder:
    case SurfaceKind::kCone: {
      auto curve = ruled(points, surface, plane);
      return curve ? curve : about_axis(points, surface, plane, fit_tolerance);
    }
    case SurfaceKind::kPlane:
    case SurfaceKind::kRevolution:
    case SurfaceKind::kFree: break;
  }
  return {};
}

double SectionCurve::angle(const Vec3& p) const {
  const Vec3 from_centre = p - centre_;
  return std::atan2(dot(from_centre, y_), dot(from_centre, x_));
}

Vec3 SectionCurve::point(double angle) const {
  const Vec3 outwards = std::cos(angle) * x_ + std::sin(angle) * y_;
  const Vec3 from_centre = radius_ * outwards;
  if (!is_ruled_) return centre_ + from_centre;
  const Vec3 ruling = std::cos(half_angle_) * axis_ + std::sin(half_angle_) * outwards;
  const double along = (offset_ - dot(from_centre, normal_)) / dot(ruling, normal_);
  // Only the way from the centre is computed, so nothing is lost far from the origin.
  return centre_ + (from_centre + along * ruling);
}

/// Turns the frame so that angle 0 is at a point. Returns false if the point is on the axis.
bool SectionCurve::begin_at(const Vec3& p) {
  const Vec3 from_centre = p - centre_;
  x_ = normalized(from_centre - dot(from_centre, axis_) * axis_);
  y_ = cross(axis_, x_);
  return norm_squared(x_) > 0;
}

/// Returns the circle, if all points lie on it. Without a given radius, the radius is their mean distance from the
/// centre.
std::optional<SectionCurve> SectionCurve::circle(std::span<const Vec3> points, const Vec3& centre, const Vec3& axis,
                                                 std::optional<double> radius, double fit_tolerance) {
  SectionCurve curve;
  curve.centre_ = centre;
  curve.axis_ = axis;
  if (!curve.begin_at(points.front())) return {};
  if (!radius) {
    double sum = 0;
    for (const Vec3& p : points) sum += distance_from_axis(p, centre, axis);
    radius = sum / static_cast<double>(points.size());
  }
  curve.radius_ = *radius;
  for (const Vec3& p : points) {
    const double across = distance_from_axis(p, centre, axis) - *radius, along = dot(p - centre, axis);
    if (!(std::hypot(across, along) <= 2 * fit_tolerance)) return {};
  }
  return curve;
}

/// Returns the section of a cylinder or cone by a plane that no ruling nearly runs along.
std::optional<SectionCurve> SectionCurve::ruled(std::span<const Vec3> points, const AnalyticSurface& surface,
                                                const Plane& plane) {
  SectionCurve curve;
  curve.is_ruled_ = true;
  curve.axis_ = surface.axis;
  curve.normal_ = plane.normal;
  const bool is_cone = surface.kind == SurfaceKind::kCone;
  if (is_cone) curve.half_angle_ = surface.half_angle;
  const double slope = dot(surface.axis, plane.normal), height = dot(plane.origin - surface.origin, plane.normal);
  if (std::fabs(slope) >= kMinSlope) {
    curve.centre_ = surface.origin + (height / slope) * surface.axis;
  } else {
    // Any circle about the axis will do: the plane may meet the axis far away, or not at all.
    curve.centre_ = surface.origin + dot(points.front() - surface.origin, surface.axis) * surface.axis;
    curve.offset_ = dot(plane.origin - curve.centre_, plane.normal);
  }
  curve.radius_ =
      is_cone ? dot(curve.centre_ - surface.origin, surface.axis) * std::tan(surface.half_angle) : surface.radius;
  if (!(curve.radius_ > 0) || !curve.begin_at(points.front())) return {};
  for (const Vec3& p : points) {
    const double along = dot(is_cone ? normalized(p - surface.origin) : surface.axis, plane.normal);
    // The plane must lie before the apex of a cone, seen along every ruling that the points are on.
    if (!(std::fabs(along) >= kMinSlope) || (is_cone && !(along * height > 0))) return {};
  }
  return curve;
}

std::optional<SectionCurve> SectionCurve::of_sphere(std::span<const Vec3> points, const AnalyticSurface& sphere,
                                                    const Plane& plane, double fit_tolerance) {
  const double height = dot(plane.origin - sphere.origin, plane.normal);
  std::optional<double> radius;
  if (std::fabs(height) <= kNearTouching * sphere.radius) radius = cut_radius(sphere.radius, height);
  return circle(points, sphere.origin + height * plane.normal, plane.normal, radius, fit_tolerance);
}

std::optional<SectionCurve> SectionCurve::of_torus(std::span<const Vec3> points, const AnalyticSurface& torus,
                                                   const Plane& plane, double fit_tolerance) {
  if (std::fabs(dot(torus.axis, plane.normal)) > 0.5) return about_axis(points, torus, plane, fit_tolerance);
  // A plane through the axis cuts the tube in circles. The plane of a small patch fits its points, but may miss the
  // axis, so the points tell how the half-plane of the circle is turned.
  Vec3 in_plane = cross(torus.axis, plane.normal);
  if (dot(points.front() - torus.origin, in_plane) < 0) in_plane = -in_plane;
  Vec3 sum;
  for (const Vec3& p : points) {
    const Vec3 way = p - torus.origin, across = way - dot(way, torus.axis) * torus.axis;
    sum += dot(across, in_plane) < 0 ? -across : across;
  }
  if (norm_squared(sum) == 0) return {};
  const Vec3 to_tube = normalized(sum);
  return circle(points, torus.origin + torus.radius * to_tube, normalized(cross(to_tube, torus.axis)),
                torus.minor_radius, fit_tolerance);
}

/// Returns the circle about the axis that fits the points. The plane must lie across the axis.
std::optional<SectionCurve> SectionCurve::about_axis(std::span<const Vec3> points, const AnalyticSurface& surface,
                                                     const Plane& plane, double fit_tolerance) {
  const double slope = dot(surface.axis, plane.normal);
  if (!(std::fabs(slope) > 0.99)) return {};
  const double height = dot(plane.origin - surface.origin, plane.normal) / slope;
  const Vec3 centre = surface.origin + height * surface.axis;
  std::optional<double> radius;
  if (surface.kind == SurfaceKind::kTorus && std::fabs(height) <= kNearTouching * surface.minor_radius) {
    const double tube = cut_radius(surface.minor_radius, height);
    const bool is_outside = distance_from_axis(points.front(), centre, surface.axis) > surface.radius;
    radius = surface.radius + (is_outside ? tube : -tube);
  }
  return circle(points, centre, slope > 0 ? plane.normal : -plane.normal, radius, fit_tolerance);
}

}  // namespace remesh
