#include "core/patches/curved/curved_faces.h"

#include <algorithm>
#include <numbers>

namespace remesh {
namespace {

/// Columns that are one width apart, with steps of 1.94 widths, make one triangle per this number of squared widths.
constexpr double kColumnArea = 0.97;
/// The source of the following numbers is experiments.md, Prediction of curved patches. A min angle makes this many
/// times as many faces in patches with columns.
constexpr double kFacesForAngle = 1.7;
/// Most cylinders and cones are divided into strips, with triangles that are twice as long.
constexpr double kFacesInStrips = 1.15;
/// A ball has this many times the faces that equilateral triangles with edges of the max length would have.
constexpr double kCurvedFacesPerIdeal = 1.9, kCurvedFacesPerIdealByAngle = 1.6;
/// The edges of a ball are this part of the length that the turn allows, because triangles are deeper than their edges.
constexpr double kEdgeOfBall = 0.866;

}  // namespace

double curved_faces_at_one(const AnalyticSurface& shape, const Vec3& at, double area, bool by_angle) {
  if (shape.kind == SurfaceKind::kSphere) {
    const double factor = by_angle ? kCurvedFacesPerIdealByAngle : kCurvedFacesPerIdeal;
    const double edge = kEdgeOfBall * shape.radius;
    return factor * area / (std::numbers::sqrt3 / 4 * edge * edge);
  }
  // Without a bound on angles, edges run along a ruling from one end of the patch to the other.
  if (!by_angle && shape.kind != SurfaceKind::kTorus) return 0;
  double radius = shape.kind == SurfaceKind::kCylinder ? shape.radius : shape.distance_from_axis(at);
  if (shape.kind == SurfaceKind::kTorus) radius = std::min(radius, shape.minor_radius);
  if (!(radius > 0)) return 0;
  const double factor = shape.kind == SurfaceKind::kTorus ? kFacesForAngle : kFacesInStrips;
  return (by_angle ? factor : 1) * area / (kColumnArea * radius * radius);
}

}  // namespace remesh
