#include "core/geometry/surfaces/surface_integral.h"

#include <cmath>
#include <cstddef>
#include <numbers>

namespace remesh {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kPoints = SurfaceIntegral::kPoints;

/// The rules that integrate and differentiate a polynomial which is given by its values at Chebyshev's points.
/// Source: L. N. Trefethen, Spectral Methods in MATLAB, 2000, chapters 6 and 12.
struct Rules {
  std::array<double, kPoints> places{};
  std::array<double, kPoints> weights{};
  std::array<std::array<double, kPoints>, kPoints> slopes{};

  Rules() {
    constexpr int kLast = kPoints - 1;
    static_assert(kLast % 2 == 0);
    for (int i = 0; i < kPoints; ++i) {
      // The sine of half of the angle has no cancellation near 0.
      const double sine = std::sin(kPi * i / (2 * kLast));
      places[at(i)] = sine * sine;
      double sum = 1;
      for (int k = 1; k <= kLast / 2; ++k)
        sum -= (k == kLast / 2 ? 1.0 : 2.0) / (4.0 * k * k - 1) * std::cos(2 * kPi * k * i / kLast);
      weights[at(i)] = (is_end(i) ? 1.0 : 2.0) / kLast * sum / 2;
    }
    for (int i = 0; i < kPoints; ++i)
      for (int j = 0; j < kPoints; ++j) {
        if (i == j) continue;
        const double ratio = (is_end(j) ? 0.5 : 1.0) / (is_end(i) ? 0.5 : 1.0) * ((i + j) % 2 == 0 ? 1 : -1);
        slopes[at(i)][at(j)] = ratio / (places[at(i)] - places[at(j)]);
        slopes[at(i)][at(i)] -= slopes[at(i)][at(j)];
      }
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static bool is_end(int i) { return i == 0 || i == kPoints - 1; }
};

const Rules& rules() {
  static const Rules kRules;
  return kRules;
}

}  // namespace

const std::array<double, kPoints>& SurfaceIntegral::places() { return rules().places; }

SurfaceIntegral::SurfaceIntegral(const AnalyticSurface& shape, const Vec3& middle, double unit)
    : shape_(shape), unit_(unit), centre_(shape.origin) {
  const Vec3 towards = middle - shape.origin;
  z_ = shape.kind == SurfaceKind::kSphere ? normalized(towards) : shape.axis;
  x_ = unit_across(z_);
  y_ = cross(z_, x_);
  // Any point of a cylinder's axis serves. One beside the piece loses no digits.
  if (shape.kind == SurfaceKind::kCylinder) centre_ = shape.origin + dot(towards, shape.axis) * shape.axis;
  shape_.radius /= unit;
  shape_.minor_radius /= unit;
  if (shape.kind == SurfaceKind::kTorus) {
    const Vec3 q = (1 / unit) * towards;
    middle_angle_ = tube_angle({dot(q, x_), dot(q, y_), dot(q, z_)});
  }
}

/// Returns the angle around the tube, at most half a turn from the middle.
double SurfaceIntegral::tube_angle(const Vec3& p) const {
  const double angle = std::atan2(p.z, std::hypot(p.x, p.y) - shape_.radius) - middle_angle_;
  return angle - 2 * kPi * std::nearbyint(angle / (2 * kPi)) + middle_angle_;
}

/// Returns the integrand of the volume per d(angle around the axis), divided by the square of the distance from the
/// axis. The point is relative to the axes.
double SurfaceIntegral::volume_form(const Vec3& p) const {
  const double r = shape_.radius, squared = p.x * p.x + p.y * p.y;
  switch (shape_.kind) {
    case SurfaceKind::kCylinder: return -r * r / 3 * p.z / squared;
    // At the middle of the piece, which is on the axis, this is finite.
    case SurfaceKind::kSphere: return r * r * r / 3 / (norm(p) * (norm(p) + p.z));
    case SurfaceKind::kTorus: {
      const double t = shape_.minor_radius, angle = tube_angle(p), from_middle = angle - middle_angle_;
      return -t / 3 * ((r * r + t * t) * std::sin(angle) + r * t * (1.5 * from_middle + std::sin(2 * angle) / 4)) /
             squared;
    }
    default: return 0;
  }
}

/// Returns the same for the area.
double SurfaceIntegral::area_form(const Vec3& p) const {
  const double r = shape_.radius, squared = p.x * p.x + p.y * p.y;
  switch (shape_.kind) {
    case SurfaceKind::kCylinder: return -r * p.z / squared;
    case SurfaceKind::kSphere: return r * r / (norm(p) * (norm(p) + p.z));
    // The distance of a point of the cone from the axis is its distance from the apex times the sine.
    case SurfaceKind::kCone: return -1 / (2 * std::sin(shape_.half_angle));
    case SurfaceKind::kTorus: {
      const double t = shape_.minor_radius, angle = tube_angle(p);
      return -t * (r * (angle - middle_angle_) + t * std::sin(angle)) / squared;
    }
    default: return 0;
  }
}

void SurfaceIntegral::add(const Curve& curve) {
  const Rules& rule = rules();
  Curve p;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 q = (1 / unit_) * (curve[i] - centre_);
    p[i] = {dot(q, x_), dot(q, y_), dot(q, z_)};
  }
  const Vec3 middle = 0.5 * (p.front() + p.back());
  for (std::size_t i = 0; i < p.size(); ++i) {
    Vec3 slope;
    for (std::size_t j = 0; j < p.size(); ++j) slope += rule.slopes[i][j] * p[j];
    volume_ -= rule.weights[i] * dot(middle, cross(p[i], slope)) / 6;
    const double turn = rule.weights[i] * (p[i].x * slope.y - p[i].y * slope.x);
    volume_ += turn * volume_form(p[i]);
    area_ += turn * area_form(p[i]);
  }
}

}  // namespace remesh
