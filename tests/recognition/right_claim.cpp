#include "tests/recognition/right_claim.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace remesh::recognition {
namespace {

using test::PlainSurface;

constexpr double kRadiusPart = 1e-3;
constexpr double kRadiansPerDegree = std::numbers::pi / 180;

double rise(double radius, double degrees) {
  return radius * (1 - std::cos(std::min(degrees, 360.0) / 2 * kRadiansPerDegree));
}

struct Span {
  double length = 0, radius = 0;  ///< along the axis; the largest radius
};
Span span_along(const PlainSurface& s, std::span<const Vec3> points) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  Span span;
  const Vec3 axis = normalized(s.axis);
  for (const Vec3& p : points) {
    const double h = dot(p - s.point, axis);
    low = std::min(low, h);
    high = std::max(high, h);
    span.radius = std::max(span.radius, norm(cross(p - s.point, axis)));
  }
  span.length = std::max(0.0, high - low);
  return span;
}

bool is_near(double claimed, double is, double deviation, double arc_rise) {
  const double part = arc_rise > 0 ? std::max(kRadiusPart, deviation / arc_rise) : HUGE_VAL;
  return std::fabs(claimed - is) <= part * is;
}

}  // namespace

double told_deviation(const RecognisedSurface& record) { return record.deviation; }

double least_rise(const PlainSurface& surface, std::span<const Vec3> points) {
  const test::Arcs arcs = test::arcs_of(surface, points);
  switch (surface.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: return rise(surface.radius, arcs.turn);
    case SurfaceKind::kCone: return rise(span_along(surface, points).radius, arcs.turn);
    case SurfaceKind::kTorus: return std::min(rise(surface.radius, arcs.turn), rise(surface.tube, arcs.tube));
    default: return HUGE_VAL;
  }
}

bool Evidence::is_enough(const PlainSurface& truth, std::span<const Vec3> points) const {
  constexpr std::size_t kFacets = 8;
  constexpr double kDeviations = 8;
  const std::size_t parameters = truth.kind == SurfaceKind::kSphere     ? 4
                                 : truth.kind == SurfaceKind::kCylinder ? 5
                                 : truth.kind == SurfaceKind::kCone     ? 6
                                                                        : 7;
  return facets >= kFacets && corners >= 2 * parameters && least_rise(truth, points) >= kDeviations * deviation;
}

bool is_right_claim(const PlainSurface& claim, const PlainSurface& truth, std::span<const Vec3> points,
                    double deviation) {
  if (claim.kind != truth.kind || truth.kind == SurfaceKind::kFree) return false;
  const test::Arcs arcs = test::arcs_of(truth, points);
  switch (truth.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: return is_near(claim.radius, truth.radius, deviation, rise(truth.radius, arcs.turn));
    case SurfaceKind::kCone: {
      const auto [length, radius] = span_along(truth, points);
      const double difference = length * std::fabs(std::tan(claim.half_deg * kRadiansPerDegree) -
                                                   std::tan(truth.half_deg * kRadiansPerDegree));
      return is_near(radius + difference, radius, deviation, rise(radius, arcs.turn));
    }
    case SurfaceKind::kTorus: {
      const double ring = std::fabs(claim.radius), tube_rise = rise(truth.tube, arcs.tube);
      return is_near(claim.tube, truth.tube, deviation, tube_rise) &&
             (is_near(ring, truth.radius, deviation, rise(truth.radius, arcs.turn)) ||
              // A short arc of the tube says as little about its middle as about its radius.
              std::fabs(ring - truth.radius) <= std::max(kRadiusPart, deviation / tube_rise) * truth.tube);
    }
    default: return true;
  }
}

}  // namespace remesh::recognition
