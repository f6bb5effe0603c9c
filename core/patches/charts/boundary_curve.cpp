#include "core/patches/charts/boundary_curve.h"

#include <algorithm>
#include <cmath>

namespace remesh {
namespace {

/// Surfaces that meet at a smaller angle are nearly tangent: the sine of 10 degrees.
constexpr double kMinSine = 0.17;
constexpr int kSteps = 12;
/// A point counts as on the surface if its distance is at most this multiple of the end points' distance, or this part
/// of the curve's length.
constexpr double kLikeEnds = 4, kOfLength = 1e-9;

/// Returns the part of a surface's normal across a direction.
Vec3 normal_across(const AnalyticSurface& surface, const Vec3& p, const Vec3& direction) {
  const Vec3 normal = surface.normal(p);
  return normal - dot(normal, direction) * direction;
}

bool do_meet_clearly(const AnalyticSurface& first, const AnalyticSurface& second, const Vec3& from, const Vec3& to) {
  const Vec3 direction = normalized(to - from);
  for (const Vec3& p : {from, 0.5 * (from + to), to}) {
    const Vec3 a = normal_across(first, p, direction), b = normal_across(second, p, direction);
    if (!(norm(a) > kMinSine && norm(b) > kMinSine)) return false;
    if (!(norm(cross(a, b)) > kMinSine * norm(a) * norm(b))) return false;
  }
  return true;
}

bool has_axis(const AnalyticSurface& surface) {
  return surface.kind == SurfaceKind::kCylinder || surface.kind == SurfaceKind::kCone ||
         surface.kind == SurfaceKind::kTorus;
}

}  // namespace

std::optional<CurveTrace> CurveTrace::choose(const Vec3& from, const Vec3& to, const AnalyticSurface& curved,
                                             const std::optional<AnalyticSurface>& other) {
  const double slack = kOfLength * norm(to - from);
  const auto is_on = [&](const Vec3& p, const AnalyticSurface& surface) {
    const double of_ends = std::max(std::fabs(surface.distance(from)), std::fabs(surface.distance(to)));
    return std::fabs(surface.distance(p)) <= kLikeEnds * of_ends + slack;
  };
  const auto is_on_both = [&](const Vec3& p) { return is_on(p, curved) && (!other || is_on(p, *other)); };
  const Vec3 middle = 0.5 * (from + to);
  const auto fits = [&](const CurveTrace& trace) {
    const Vec3 p = trace.place(middle, from, to);
    return p != middle && is_on_both(p);
  };
  if (is_on_both(middle)) return std::nullopt;  // the straight line is the curve
  for (const AnalyticSurface* surface : {&curved, other ? &*other : nullptr}) {
    if (surface == nullptr || !has_axis(*surface)) continue;
    const CurveTrace circle(Way::kCircle, *surface, {});
    if (fits(circle)) return circle;
  }
  if (other && do_meet_clearly(curved, *other, from, to)) return CurveTrace(Way::kIntersection, curved, *other);
  for (const AnalyticSurface* surface : {&curved, other ? &*other : nullptr}) {
    if (surface == nullptr || surface->kind == SurfaceKind::kPlane) continue;
    const CurveTrace nearest(Way::kNearest, *surface, {});
    if (fits(nearest)) return nearest;
  }
  return std::nullopt;
}

Vec3 CurveTrace::place(const Vec3& on_line, const Vec3& from, const Vec3& to) const {
  return way_ == Way::kCircle ? on_circle(on_line, from, to) : on_surfaces(on_line, from, to);
}

/// Returns the place at the angle of the point around the axis. Its height and distance from the axis are between those
/// of the ends.
Vec3 CurveTrace::on_circle(const Vec3& on_line, const Vec3& from, const Vec3& to) const {
  const Vec3& axis = first_.axis;
  const auto across = [&](const Vec3& p) {
    const Vec3 way = p - first_.origin;
    return way - dot(way, axis) * axis;
  };
  const Vec3 here = across(on_line);
  const double size = norm(here);
  if (!(size > 0)) return on_line;
  const double t = norm(on_line - from) / norm(to - from);
  const double radius = (1 - t) * norm(across(from)) + t * norm(across(to));
  return on_line + (radius / size - 1) * here;
}

Vec3 CurveTrace::on_surfaces(const Vec3& on_line, const Vec3& from, const Vec3& to) const {
  const Vec3 direction = normalized(to - from);
  const double length = norm(to - from);
  Vec3 p = on_line;
  for (int i = 0; i < kSteps; ++i) {
    const Vec3 a = normal_across(first_, p, direction);
    const double aa = dot(a, a), to_a = -first_.distance(p);
    Vec3 step;
    if (way_ == Way::kIntersection) {
      const Vec3 b = normal_across(second_, p, direction);
      const double ab = dot(a, b), bb = dot(b, b), to_b = -second_.distance(p), determinant = aa * bb - ab * ab;
      if (!(determinant > 0)) return on_line;
      step = ((to_a * bb - to_b * ab) / determinant) * a + ((to_b * aa - to_a * ab) / determinant) * b;
    } else {
      if (!(aa > 0)) return on_line;
      step = (to_a / aa) * a;
    }
    p += step;
    if (!(norm(p - on_line) <= length)) return on_line;
    // Newton's method doubles the digits with each step.
    if (norm(step) <= 0x1p-40 * length) return p;
  }
  return on_line;
}

}  // namespace remesh
