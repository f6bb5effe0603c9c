#include "core/geometry/surfaces/surface_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace remesh {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// At a tube that touches the axis, the square root of the ratio of its distances from the axis is 0 up to rounding.
constexpr double kNoPart = 1e-6;

/// Where a tube ends at the axis, points beyond this share of the infinite way to the end, or behind the end, are moved
/// back to it.
constexpr double kNearEnd = 1 - 1e-9, kHalfTurn = 0.999 * std::numbers::pi;

/// A squeezed map multiplies lengths along rulings by this. A patch whose length is a thousand times the width of its
/// edges then has about the same length and width.
constexpr double kSqueeze = 0x1p-10;

/// Returns a unit vector across an axis: in the direction of `towards`, or any if that is along the axis.
Vec3 across(const Vec3& axis, const Vec3& towards) {
  const Vec3 part = towards - dot(towards, axis) * axis;
  if (norm_squared(part) > 1e-12 * norm_squared(towards)) {
    const Vec3 unit = normalized(part);
    return normalized(unit - dot(unit, axis) * axis);
  }
  return unit_across(axis);
}

}  // namespace

bool SurfaceMap::can_map(const AnalyticSurface& shape) {
  switch (shape.kind) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: return shape.radius > 0;
    case SurfaceKind::kCone: return shape.half_angle > 0 && shape.half_angle < std::numbers::pi / 2;
    case SurfaceKind::kTorus: return shape.minor_radius > 0 && shape.radius + shape.minor_radius > 0;
    case SurfaceKind::kPlane:
    case SurfaceKind::kRevolution:
    case SurfaceKind::kFree: break;
  }
  return false;
}

SurfaceMap::SurfaceMap(const AnalyticSurface& shape, const MappedPiece& piece)
    : shape_(shape), side_(piece.is_concave ? -1 : 1) {
  const Vec3 towards = piece.middle - shape.origin;
  axes_.z = shape.kind == SurfaceKind::kSphere ? normalized(towards) : shape.axis;
  axes_.x = across(axes_.z, shape.kind == SurfaceKind::kSphere ? Vec3{} : towards);
  axes_.y = cross(axes_.z, axes_.x);
  if (shape.kind == SurfaceKind::kCone) {
    sine_ = std::sin(shape.half_angle);
    cosine_ = std::cos(shape.half_angle);
    unit_ = radius(piece.middle);
  }
  if (shape.kind == SurfaceKind::kTorus) {
    const Vec3 q = axes_.along(towards);
    middle_angle_ = std::atan2(q.z, std::hypot(q.x, q.y) - shape.radius);
    middle_way_ = tube_way(middle_angle_);
    unit_ = shape.radius + shape.minor_radius * std::cos(middle_angle_);
  }
}

SurfaceMap SurfaceMap::squeezed() const {
  SurfaceMap map = *this;
  if (shape_.kind == SurfaceKind::kCylinder || shape_.kind == SurfaceKind::kCone) map.squeeze_ = kSqueeze;
  return map;
}

/// Returns the integral of ds / rho along the tube from where it is farthest out to an angle.
double SurfaceMap::tube_way(double angle) const {
  const double outer = shape_.radius + shape_.minor_radius, inner = shape_.radius - shape_.minor_radius;
  const double tube = 2 * shape_.minor_radius;
  if (!(inner > 0)) {
    // The tube ends at the axis, to which the way is infinite.
    const double part = std::sqrt(-inner / outer), at = std::tan(0.5 * std::clamp(angle, -kHalfTurn, kHalfTurn));
    if (!(part > kNoPart)) return tube / outer * at;
    return tube / (outer * part) * std::atanh(std::clamp(part * at, -kNearEnd, kNearEnd));
  }
  const double root = std::sqrt(outer * inner);
  const double turns = std::nearbyint(angle / kTurn);
  const double half = 0.5 * (angle - turns * kTurn);
  return tube / root * (std::atan(std::sqrt(inner / outer) * std::tan(half)) + turns * kTurn / 2);
}

double SurfaceMap::tube_angle(double way) const {
  const double outer = shape_.radius + shape_.minor_radius, inner = shape_.radius - shape_.minor_radius;
  if (!(inner > 0)) {
    const double part = std::sqrt(-inner / outer), half = way * outer / (2 * shape_.minor_radius);
    return 2 * std::atan(part > kNoPart ? std::tanh(half * part) / part : half);
  }
  const double root = std::sqrt(outer * inner);
  const double half = way * root / (2 * shape_.minor_radius);
  const double turns = std::nearbyint(half / (kTurn / 2));
  return 2 * std::atan(std::sqrt(outer / inner) * std::tan(half - turns * kTurn / 2)) + turns * kTurn;
}

Vec2 SurfaceMap::flat(const Vec3& p) const {
  const Vec3 q = axes_.along(p - shape_.origin);
  switch (shape_.kind) {
    case SurfaceKind::kCylinder: return {side_ * shape_.radius * std::atan2(q.y, q.x), squeeze_ * q.z};
    case SurfaceKind::kCone: {
      const double along = q.z * cosine_ + std::hypot(q.x, q.y) * sine_;
      if (squeeze_ != 1) return {squeeze_ * along, -side_ * unit_ * std::atan2(q.y, q.x)};
      const double angle = -side_ * std::atan2(q.y, q.x) * sine_;
      return {along * std::cos(angle), along * std::sin(angle)};
    }
    case SurfaceKind::kSphere: {
      const double length = norm(q);
      const double factor = 2 * shape_.radius / (length + q.z);
      return {side_ * factor * q.x, factor * q.y};
    }
    case SurfaceKind::kTorus: {
      const double angle = std::atan2(q.z, std::hypot(q.x, q.y) - shape_.radius);
      const double turns = std::nearbyint((angle - middle_angle_) / kTurn);
      return {side_ * unit_ * std::atan2(q.y, q.x), unit_ * (tube_way(angle - turns * kTurn) - middle_way_)};
    }
    default: return {};
  }
}

Vec3 SurfaceMap::point(Vec2 q) const {
  const double r = shape_.radius;
  Vec3 place;
  switch (shape_.kind) {
    case SurfaceKind::kCylinder: {
      const double angle = side_ * q.x / r;
      place = {r * std::cos(angle), r * std::sin(angle), q.y / squeeze_};
      break;
    }
    case SurfaceKind::kCone: {
      const bool is_squeezed = squeeze_ != 1;
      const double along = is_squeezed ? q.x / squeeze_ : std::hypot(q.x, q.y);
      const double angle = -side_ * (is_squeezed ? q.y / unit_ : std::atan2(q.y, q.x) / sine_);
      place = {along * sine_ * std::cos(angle), along * sine_ * std::sin(angle), along * cosine_};
      break;
    }
    case SurfaceKind::kSphere: {
      const double u = q.x / (2 * r), v = q.y / (2 * r), squared = u * u + v * v, factor = r / (1 + squared);
      place = {side_ * 2 * u * factor, 2 * v * factor, (1 - squared) * factor};
      break;
    }
    case SurfaceKind::kTorus: {
      const double around = side_ * q.x / unit_, tube = tube_angle(q.y / unit_ + middle_way_);
      const double rho = r + shape_.minor_radius * std::cos(tube);
      place = {rho * std::cos(around), rho * std::sin(around), shape_.minor_radius * std::sin(tube)};
      break;
    }
    default: break;
  }
  return shape_.origin + axes_.in_space(place);
}

double SurfaceMap::radius(const Vec3& p) const {
  const Vec3 q = axes_.along(p - shape_.origin);
  return std::hypot(q.x, q.y);
}

SurfaceMap::Around SurfaceMap::around(const Vec3& p) const {
  const Vec3 q = axes_.along(p - shape_.origin);
  const double angle = std::atan2(q.y, q.x);
  switch (shape_.kind) {
    case SurfaceKind::kCylinder: return {angle, q.z / shape_.radius};
    case SurfaceKind::kCone: return {angle, std::log(q.z * cosine_ + std::hypot(q.x, q.y) * sine_) / sine_};
    case SurfaceKind::kTorus: {
      const double tube = std::atan2(q.z, std::hypot(q.x, q.y) - shape_.radius);
      const double turns = std::nearbyint((tube - middle_angle_) / kTurn);
      return {angle, tube_way(tube - turns * kTurn) - middle_way_};
    }
    default: return {angle, 0};
  }
}

Vec3 SurfaceMap::point(const Around& place) const {
  double rho = shape_.radius, height = 0;
  switch (shape_.kind) {
    case SurfaceKind::kCylinder: height = place.way * shape_.radius; break;
    case SurfaceKind::kCone: {
      const double along = std::exp(place.way * sine_);
      rho = along * sine_;
      height = along * cosine_;
      break;
    }
    case SurfaceKind::kTorus: {
      const double tube = tube_angle(place.way + middle_way_);
      rho += shape_.minor_radius * std::cos(tube);
      height = shape_.minor_radius * std::sin(tube);
      break;
    }
    default: break;
  }
  return shape_.origin + axes_.in_space({rho * std::cos(place.angle), rho * std::sin(place.angle), height});
}

Vec3 SurfaceMap::normal(Vec2 q) const { return side_ * shape_.normal(point(q)); }

double SurfaceMap::stretch(Vec2 q) const {
  switch (shape_.kind) {
    case SurfaceKind::kSphere: {
      const double u = q.x / (2 * shape_.radius), v = q.y / (2 * shape_.radius);
      return 1 / (1 + u * u + v * v);
    }
    case SurfaceKind::kTorus:
      return (shape_.radius + shape_.minor_radius * std::cos(tube_angle(q.y / unit_ + middle_way_))) / unit_;
    case SurfaceKind::kCone: return squeeze_ != 1 ? q.x / squeeze_ * sine_ / unit_ : 1;
    default: return 1;
  }
}

}  // namespace remesh
