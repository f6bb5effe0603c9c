/// Curved surfaces in any place, with parameters: the tests' own formulas for points of them.
#pragma once

#include <cmath>

#include "core/geometry/surfaces/analytic_surface.h"
#include "tests/support/shapes.h"

namespace remesh::test {

/// Returns a surface with all lengths times a factor.
inline AnalyticSurface scaled(AnalyticSurface surface, double factor) {
  surface.origin = factor * surface.origin;
  surface.radius *= factor;
  surface.minor_radius *= factor;
  return surface;
}

/// A surface in some place, with parameters u and v. Its normal points to the side from which the parameters turn
/// counter-clockwise.
struct CurvedPlace {
  SurfaceKind kind = SurfaceKind::kCylinder;
  double radius = 1, minor_radius = 0, half_angle = 0;
  Vec3 origin{};
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  /// A point at the angle u around the axis. Here v is the height along the axis of a cylinder or cone, the latitude on
  /// a sphere, and the angle around the tube of a torus. `off` is the distance from the surface.
  Vec3 point(double u, double v, double off = 0) const {
    double rho = radius + off, height = v;
    if (kind == SurfaceKind::kCone) {
      rho = v * std::tan(half_angle) + off * std::cos(half_angle);
      height = v - off * std::sin(half_angle);
    } else if (kind == SurfaceKind::kSphere) {
      height = (radius + off) * std::sin(v);
      rho = (radius + off) * std::cos(v);
    } else if (kind == SurfaceKind::kTorus) {
      height = (minor_radius + off) * std::sin(v);
      rho = radius + (minor_radius + off) * std::cos(v);
    }
    return origin + rho * std::cos(u) * x + rho * std::sin(u) * y + height * z;
  }
  AnalyticSurface shape() const {
    return {kind, origin, kind == SurfaceKind::kSphere ? Vec3{} : z, radius, minor_radius, half_angle};
  }

  CurvedPlace turned(const Vec3& axis, double degrees, const Vec3& by) const {
    PolygonMesh frame;
    for (const Vec3& p : {x, y, z, origin}) frame.positions.push_back(p);
    frame = shapes::rotated(frame, axis, degrees);
    CurvedPlace out = *this;
    out.x = normalized(frame.positions[VertexId(0)]);
    out.z = normalized(frame.positions[VertexId(2)]);
    out.y = cross(out.z, out.x);
    out.origin = frame.positions[VertexId(3)] + by;
    return out;
  }
};

}  // namespace remesh::test
