#include "core/geometry/surfaces/analytic_surface.h"

#include <algorithm>
#include <cmath>

namespace remesh {
namespace {

/// A point relative to an axis.
struct AxialPlace {
  double height;  ///< along the axis
  double radius;  ///< distance from the axis
  Vec3 outwards;  ///< unit direction away from the axis; null on it
};

AxialPlace place_along(const AnalyticSurface& surface, const Vec3& p) {
  const Vec3 from_origin = p - surface.origin;
  const double height = dot(from_origin, surface.axis);
  const Vec3 across = from_origin - height * surface.axis;
  const double radius = norm(across);
  return {height, radius, radius > 0 ? (1 / radius) * across : Vec3{}};
}

}  // namespace

double AnalyticSurface::distance(const Vec3& p) const {
  switch (kind) {
    case SurfaceKind::kPlane: return dot(p - origin, axis);
    case SurfaceKind::kSphere: return norm(p - origin) - radius;
    case SurfaceKind::kCylinder: return place_along(*this, p).radius - radius;
    case SurfaceKind::kCone: {
      const AxialPlace at = place_along(*this, p);
      return at.radius * std::cos(half_angle) - at.height * std::sin(half_angle);
    }
    case SurfaceKind::kTorus: {
      const AxialPlace at = place_along(*this, p);
      return std::hypot(at.radius - radius, at.height) - minor_radius;
    }
    case SurfaceKind::kRevolution:
    case SurfaceKind::kFree: break;
  }
  return 0;
}

Vec3 AnalyticSurface::normal(const Vec3& p) const {
  switch (kind) {
    case SurfaceKind::kPlane: return axis;
    case SurfaceKind::kSphere: return normalized(p - origin);
    case SurfaceKind::kCylinder: return place_along(*this, p).outwards;
    case SurfaceKind::kCone: return std::cos(half_angle) * place_along(*this, p).outwards - std::sin(half_angle) * axis;
    case SurfaceKind::kTorus: {
      const AxialPlace at = place_along(*this, p);
      return normalized((at.radius - radius) * at.outwards + at.height * axis);
    }
    case SurfaceKind::kRevolution:
    case SurfaceKind::kFree: break;
  }
  return {};
}

double AnalyticSurface::distance_from_axis(const Vec3& p) const {
  const Vec3 way = p - origin;
  return norm(way - dot(way, axis) * axis);
}

bool is_same(const AnalyticSurface& a, const AnalyticSurface& b) {
  return a.kind == b.kind && a.origin == b.origin && a.axis == b.axis && a.radius == b.radius &&
         a.minor_radius == b.minor_radius && a.half_angle == b.half_angle;
}

Vec3 canonical_direction(const Vec3& axis) {
  const double largest = std::max({std::fabs(axis.x), std::fabs(axis.y), std::fabs(axis.z)});
  for (int i = 0; i < 3; ++i)
    if (std::fabs(axis[i]) > 0.999 * largest) return axis[i] < 0 ? -axis : axis;
  return axis;
}

std::string_view kind_name(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kPlane: return "plane";
    case SurfaceKind::kCylinder: return "cylinder";
    case SurfaceKind::kCone: return "cone";
    case SurfaceKind::kSphere: return "sphere";
    case SurfaceKind::kTorus: return "torus";
    case SurfaceKind::kRevolution: return "revolution";
    case SurfaceKind::kFree: return "free";
  }
  return "";
}

}  // namespace remesh
