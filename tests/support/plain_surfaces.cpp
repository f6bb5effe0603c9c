#include "tests/support/plain_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace remesh::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// The half-plane through the axis in which a point lies. All surfaces but planes are turned around an axis, so the
/// nearest point lies in the same half-plane.
struct HalfPlane {
  Vec3 origin;
  Vec3 up;        ///< unit direction of the axis
  Vec3 outwards;  ///< unit direction away from the axis, towards the point
  Vec2 place;     ///< the point: distance from the axis, height

  HalfPlane(const Vec3& point, const Vec3& axis, const Vec3& p) : origin(point), up(normalized(axis)) {
    const Vec3 d = p - origin;
    const Vec3 moment = cross(up, d);
    const Vec3 away = cross(moment, up);
    outwards = norm(away) > 0 ? normalized(away) : across(up).x;
    place = {norm(moment), dot(up, d)};
  }
  Vec3 point(Vec2 at) const { return origin + at.x * outwards + at.y * up; }
  Vec3 direction(Vec2 d) const { return d.x * outwards + d.y * up; }
};

Vec2 nearest_of_segment(Vec2 a, Vec2 b, Vec2 p) {
  const Vec2 along = b - a;
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(p - a, along) / squared, 0.0, 1.0) : 0.0;
  return a + t * along;
}

/// The nearest point of a circle around `centre`, which may reach over the axis.
Vec2 nearest_of_circle(Vec2 centre, double radius, Vec2 p) {
  const Vec2 d = p - centre;
  const double n = norm(d);
  return n > 0 ? centre + (radius / n) * d : centre + Vec2{radius, 0};
}

}  // namespace

Across across(const Vec3& axis) {
  const Vec3 z = normalized(axis);
  const double smallest = std::min({std::fabs(z.x), std::fabs(z.y), std::fabs(z.z)});
  const Vec3 other = smallest == std::fabs(z.x)   ? Vec3{1, 0, 0}
                     : smallest == std::fabs(z.y) ? Vec3{0, 1, 0}
                                                  : Vec3{0, 0, 1};
  const Vec3 x = normalized(cross(other, z));
  return {x, cross(z, x)};
}

Vec3 PlainSurface::nearest(const Vec3& p) const {
  if (kind == SurfaceKind::kPlane) {
    const Vec3 n = normalized(axis);
    return p - dot(p - point, n) * n;
  }
  if (kind == SurfaceKind::kSphere) {
    const Vec3 d = p - point;
    return point + radius * (norm(d) > 0 ? normalized(d) : Vec3{1, 0, 0});
  }
  const HalfPlane half(point, axis, p);
  switch (kind) {
    case SurfaceKind::kCylinder: return half.point({radius, half.place.y});
    case SurfaceKind::kCone: {
      const Vec2 ruling{std::sin(half_deg * kDegree), std::cos(half_deg * kDegree)};
      return half.point(std::max(0.0, dot(half.place, ruling)) * ruling);
    }
    case SurfaceKind::kTorus: {
      // The circle beyond the axis reaches over it if the tube is wider than the ring.
      const std::array<Vec2, 2> both{nearest_of_circle({radius, 0}, tube, half.place),
                                     nearest_of_circle({-radius, 0}, tube, half.place)};
      const bool is_second = tube > radius && norm(both[1] - half.place) < norm(both[0] - half.place);
      return half.point(both[is_second ? 1 : 0]);
    }
    case SurfaceKind::kRevolution: {
      Vec2 best{HUGE_VAL, HUGE_VAL};
      for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const Vec2 at = nearest_of_segment(profile[i], profile[i + 1], half.place);
        if (norm(at - half.place) < norm(best - half.place)) best = at;
      }
      return half.point(best);
    }
    default: return {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  }
}

Vec3 PlainSurface::normal(const Vec3& p) const {
  if (kind == SurfaceKind::kPlane) return normalized(axis);
  if (kind == SurfaceKind::kSphere) return normalized(p - point);
  const HalfPlane half(point, axis, p);
  switch (kind) {
    case SurfaceKind::kCylinder: return half.outwards;
    case SurfaceKind::kCone: return half.direction({std::cos(half_deg * kDegree), -std::sin(half_deg * kDegree)});
    case SurfaceKind::kTorus: return normalized(half.direction(half.place - Vec2{radius, 0}));
    case SurfaceKind::kRevolution: {
      double best = HUGE_VAL;
      Vec2 along;
      for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const double d = norm(nearest_of_segment(profile[i], profile[i + 1], half.place) - half.place);
        if (d < best) {
          best = d;
          along = profile[i + 1] - profile[i];
        }
      }
      return normalized(half.direction({along.y, -along.x}));
    }
    default: return {};
  }
}

PlainSurface plain(const RecognisedSurface& surface) {
  PlainSurface s;
  s.kind = surface.shape.kind;
  s.point = surface.shape.origin;
  s.axis = surface.shape.axis;
  s.radius = surface.shape.radius;
  s.tube = surface.shape.minor_radius;
  s.half_deg = surface.shape.half_angle / kDegree;
  s.profile = surface.profile;
  return s;
}

double covered_turn_deg(std::vector<double> degrees) {
  if (degrees.empty()) return 0;
  std::sort(degrees.begin(), degrees.end());
  double gap = 360 - (degrees.back() - degrees.front());
  for (std::size_t i = 1; i < degrees.size(); ++i) gap = std::max(gap, degrees[i] - degrees[i - 1]);
  return 360 - gap;
}

double covered_turn_deg(const Vec3& point, const Vec3& axis, std::span<const Vec3> points) {
  const Across frame = across(axis);
  double farthest = 0;
  for (const Vec3& p : points)
    farthest = std::max(farthest, std::hypot(dot(p - point, frame.x), dot(p - point, frame.y)));
  std::vector<double> degrees;
  for (const Vec3& p : points) {
    const double x = dot(p - point, frame.x);
    const double y = dot(p - point, frame.y);
    if (std::hypot(x, y) > 1e-6 * farthest) degrees.push_back(std::atan2(y, x) / kDegree);
  }
  return covered_turn_deg(std::move(degrees));
}

Arcs arcs_of(const PlainSurface& surface, std::span<const Vec3> points) {
  Arcs arcs;
  if (surface.kind == SurfaceKind::kSphere) {
    Vec3 sum;
    for (const Vec3& p : points) sum += normalized(p - surface.point);
    double widest = 0;
    for (const Vec3& p : points)
      widest = std::max(widest, std::acos(std::clamp(dot(normalized(sum), normalized(p - surface.point)), -1.0, 1.0)));
    arcs.turn = 2 * widest / kDegree;
  } else if (surface.kind != SurfaceKind::kPlane && surface.kind != SurfaceKind::kFree) {
    arcs.turn = covered_turn_deg(surface.point, surface.axis, points);
  }
  if (surface.kind == SurfaceKind::kTorus) {
    std::vector<double> around;
    for (const Vec3& p : points) {
      const HalfPlane half(surface.point, surface.axis, p);
      around.push_back(std::atan2(half.place.y, half.place.x - surface.radius) / kDegree);
    }
    arcs.tube = covered_turn_deg(std::move(around));
  }
  return arcs;
}

}  // namespace remesh::test
