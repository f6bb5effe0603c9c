#include "core/geometry/surfaces/surface_offset.h"

namespace remesh {

AnalyticSurface offset_surface(const AnalyticSurface& shape, double offset) {
  AnalyticSurface result = shape;
  switch (shape.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: result.radius += offset; break;
    case SurfaceKind::kTorus: result.minor_radius += offset; break;
    case SurfaceKind::kCone: result.half_angle += offset; break;
    case SurfaceKind::kPlane:
    case SurfaceKind::kRevolution:
    case SurfaceKind::kFree: break;
  }
  return result;
}

double offset_lever(const AnalyticSurface& shape, const Vec3& p) {
  return shape.kind == SurfaceKind::kCone ? norm(p - shape.origin) : 1;
}

}  // namespace remesh
