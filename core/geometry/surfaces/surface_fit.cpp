#include "core/geometry/surfaces/surface_fit.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>

#include "core/base/symmetric_eigen.h"

namespace remesh {
namespace {

constexpr std::size_t kMaxParameters = 7;

Vec3 mean_of(std::span<const Vec3> points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return (1 / static_cast<double>(points.size())) * sum;
}

struct Circle {
  Vec2 centre;
  double radius;
};

/// Fits a circle by the equation |q|^2 = 2 c . q + k, which is linear in c and k.
/// Output: nothing if the points are on a line up to rounding.
template <class ToPlane>
std::optional<Circle> guess_circle(std::span<const Vec3> points, const ToPlane& to_plane) {
  Vec2 mean;
  for (const Vec3& p : points) mean = mean + to_plane(p);
  mean = (1 / static_cast<double>(points.size())) * mean;
  double xx = 0, xy = 0, yy = 0, xs = 0, ys = 0, s = 0;
  for (const Vec3& p : points) {
    const Vec2 q = to_plane(p) - mean;
    const double square = dot(q, q);
    xx += q.x * q.x;
    xy += q.x * q.y;
    yy += q.y * q.y;
    xs += q.x * square;
    ys += q.y * square;
    s += square;
  }
  const double det = xx * yy - xy * xy;
  if (!(det > 1e-26 * (xx + yy) * (xx + yy))) return std::nullopt;
  const Vec2 c{(yy * xs - xy * ys) / (2 * det), (xx * ys - xy * xs) / (2 * det)};
  const double radius = std::sqrt(s / static_cast<double>(points.size()) + dot(c, c));
  return Circle{mean + c, radius};
}

std::optional<Vec3> solve3(const Matrix<3>& a, const Vec3& b) {
  // The determinant is compared with its own terms, so a power of two before the matrix makes no difference.
  const Vec3 r0{a[0][0], a[0][1], a[0][2]}, r1{a[1][0], a[1][1], a[1][2]}, r2{a[2][0], a[2][1], a[2][2]};
  const Vec3 c12 = cross(r1, r2), c20 = cross(r2, r0), c01 = cross(r0, r1);
  const double det = dot(r0, c12);
  const double size = norm(r0) * norm(r1) * norm(r2);
  if (!(std::fabs(det) > 1e-14 * size)) return std::nullopt;
  return (1 / det) * (b.x * c12 + b.y * c20 + b.z * c01);
}

Matrix<3> covariance_of_normals(std::span<const FacetPlace> facets, const Vec3& mean) {
  Matrix<3> sum{};
  for (const FacetPlace& f : facets) {
    const Vec3 n = f.normal - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) sum[i][j] += n[i] * n[j];
  }
  return sum;
}

/// The parameters of a fit, relative to a point near the points and to a length of their size.
struct Parameters {
  SurfaceKind kind;
  Vec3 origin;  ///< a point of the axis, or the centre of a sphere
  Vec3 axis, x, y;
  std::array<double, 3> profile;  ///< see residual_of
  double cosine = 1, sine = 0;    ///< cone: cosine and sine of the half angle

  std::size_t count() const { return static_cast<std::size_t>(parameter_count(kind)); }
  void set_angle() {
    if (kind != SurfaceKind::kCone) return;
    cosine = std::cos(profile[1]);
    sine = std::sin(profile[1]);
  }
};

using Gradient = std::array<double, kMaxParameters>;

/// Returns the distance of a point from the surface, and the derivatives of it by the parameters: first by shifts of
/// the origin along x and y and by turns of the axis to x and to y, then by those of the profile. In the half-plane of
/// (r, z) with r the distance from the axis, the profile is
/// - of a cylinder the line r = p0;
/// - of a cone the line r cos p1 - z sin p1 = p0;
/// - of a torus the circle of radius p2 around (p0, p1).
/// A sphere has shifts along three axes instead, and its radius.
double residual_of(const Parameters& at, const Vec3& p, Gradient& d) {
  const Vec3 q = p - at.origin;
  if (at.kind == SurfaceKind::kSphere) {
    const double r = norm(q);
    const double inverse = r > 0 ? -1 / r : 0;
    d[0] = inverse * q.x;
    d[1] = inverse * q.y;
    d[2] = inverse * q.z;
    d[3] = -1;
    return r - at.profile[0];
  }
  const double x = dot(q, at.x), y = dot(q, at.y), z = dot(q, at.axis);
  const double r = std::sqrt(x * x + y * y);
  double distance = 0, by_r = 1, by_z = 0;
  if (at.kind == SurfaceKind::kCylinder) {
    distance = r - at.profile[0];
    d[4] = -1;
  } else if (at.kind == SurfaceKind::kCone) {
    const double c = at.cosine, s = at.sine;
    distance = r * c - z * s - at.profile[0];
    by_r = c;
    by_z = -s;
    d[4] = -1;
    d[5] = -r * s - z * c;
  } else {
    const double u = r - at.profile[0], v = z - at.profile[1], g = std::sqrt(u * u + v * v);
    distance = g - at.profile[2];
    by_r = g > 0 ? u / g : 1;
    by_z = g > 0 ? v / g : 0;
    d[4] = -by_r;
    d[5] = -by_z;
    d[6] = -1;
  }
  const double cosine = r > 0 ? x / r : 1, sine = r > 0 ? y / r : 0;
  d[0] = -by_r * cosine;
  d[1] = -by_r * sine;
  d[2] = by_z * x - by_r * cosine * z;
  d[3] = by_z * y - by_r * sine * z;
  return distance;
}

Parameters moved(Parameters at, const std::array<double, kMaxParameters>& step) {
  if (at.kind == SurfaceKind::kSphere) {
    at.origin += Vec3{step[0], step[1], step[2]};
    at.profile[0] += step[3];
    return at;
  }
  at.origin += step[0] * at.x + step[1] * at.y;
  at.axis = normalized(at.axis + step[2] * at.x + step[3] * at.y);
  at.x = normalized(at.x - dot(at.x, at.axis) * at.axis);
  at.y = cross(at.axis, at.x);
  for (std::size_t i = 4; i < at.count(); ++i) at.profile[i - 4] += step[i];
  at.set_angle();
  return at;
}

/// The sums of a step of the fit.
struct Normal {
  Matrix<kMaxParameters> matrix{};
  Gradient right{};
  double cost = 0;
};

/// Returns whether a point is so near to the apex of a cone that it was made from it.
bool is_at_apex(const Parameters& at, const Vec3& p) {
  constexpr double kNear = 1e-4;
  const Vec3 q = p - at.origin;
  const double z = dot(q, at.axis);
  return norm_squared(q - z * at.axis) < kNear * kNear;
}

Normal sums_of(const Parameters& at, std::span<const Vec3> points, double scale) {
  Normal sums;
  Gradient d{};
  const std::size_t n = at.count();
  const auto add = [&](double r) {
    sums.cost += r * r;
    for (std::size_t i = 0; i < n; ++i) {
      sums.right[i] -= r * d[i];
      for (std::size_t j = 0; j <= i; ++j) sums.matrix[i][j] += d[i] * d[j];
    }
  };
  for (const Vec3& p : points) {
    const Vec3 q = scale * p;
    if (at.kind != SurfaceKind::kCone || !is_at_apex(at, q)) {
      add(residual_of(at, q, d));
      continue;
    }
    // A cone has no derivatives in its apex. There, the distances along the three axes count.
    const Vec3 w = q - at.origin;
    const double z = dot(w, at.axis);
    d = {-at.cosine, 0, -at.cosine * z, 0, 0, 0, 0};
    add(at.cosine * dot(w, at.x));
    d = {0, -at.cosine, 0, -at.cosine * z, 0, 0, 0};
    add(at.cosine * dot(w, at.y));
    d = {0, 0, 0, 0, -1, -z * at.cosine, 0};
    add(-z * at.sine - at.profile[0]);
  }
  return sums;
}

Parameters parameters_of(const AnalyticSurface& s, const Vec3& middle, double scale) {
  Parameters at{s.kind, scale * s.origin, s.axis, {}, {}, {}};
  if (s.kind == SurfaceKind::kSphere) {
    at.profile[0] = scale * s.radius;
    return at;
  }
  at.x = unit_across(s.axis);
  at.y = cross(s.axis, at.x);
  // The origin moves along the axis to the middle of the points, so that shifts and turns are independent.
  const double along = dot(scale * (middle - s.origin), s.axis);
  at.origin += along * s.axis;
  if (s.kind == SurfaceKind::kCylinder) at.profile[0] = scale * s.radius;
  if (s.kind == SurfaceKind::kCone) at.profile = {along * std::sin(s.half_angle), s.half_angle, 0};
  if (s.kind == SurfaceKind::kTorus) at.profile = {scale * s.radius, -along, scale * s.minor_radius};
  at.set_angle();
  return at;
}

/// Rounds parameters to multiples of a step. Sizes with few decimal digits do not lie in the middle between two
/// multiples, where values that are nearly equal would be rounded apart.
Parameters rounded(Parameters at, const Vec3& middle) {
  constexpr double kStep = 0x1p-24 / 25;
  const auto round = [](double x) { return std::nearbyint(x / kStep) * kStep; };
  const auto round_all = [&](const Vec3& v) { return Vec3{round(v.x), round(v.y), round(v.z)}; };
  at.origin = middle + round_all(at.origin - middle);
  for (double& p : at.profile) p = round(p);
  if (at.kind != SurfaceKind::kSphere) {
    at.axis = normalized(round_all(at.axis));
    at.x = unit_across(at.axis);
    at.y = cross(at.axis, at.x);
  }
  at.set_angle();
  return at;
}

std::optional<AnalyticSurface> surface_of(const Parameters& at, double scale) {
  AnalyticSurface s;
  s.kind = at.kind;
  s.axis = at.axis;
  const double unit = 1 / scale;
  s.origin = unit * at.origin;
  switch (at.kind) {
    case SurfaceKind::kSphere:
    case SurfaceKind::kCylinder: s.radius = unit * at.profile[0]; break;
    case SurfaceKind::kCone: {
      double angle = at.profile[1];
      const double sine = std::sin(angle);
      if (sine == 0) return std::nullopt;
      s.origin += (-unit * at.profile[0] / sine) * at.axis;
      if (angle < 0) {
        s.axis = -s.axis;
        angle = -angle;
      }
      s.half_angle = angle;
      if (!(angle < std::numbers::pi / 2)) return std::nullopt;
      break;
    }
    case SurfaceKind::kTorus:
      s.origin += (unit * at.profile[1]) * at.axis;
      s.radius = unit * at.profile[0];
      s.minor_radius = unit * at.profile[2];
      break;
    default: return std::nullopt;
  }
  // A surface that is more than this many times as large as the points is a plane, or of a kind with fewer parameters.
  constexpr double kMaxRadius = 1e5;
  const bool is_small = std::fabs(s.radius) * scale < kMaxRadius && s.minor_radius * scale < kMaxRadius;
  const bool has_radius =
      at.kind == SurfaceKind::kCone ||
      (at.kind == SurfaceKind::kTorus ? s.minor_radius > 0 && s.radius + s.minor_radius > 0 : s.radius > 0);
  if (!is_small || !has_radius || !is_finite(s.origin) || !is_finite(s.axis)) return std::nullopt;
  return s;
}

}  // namespace

int parameter_count(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kPlane: return 3;
    case SurfaceKind::kSphere: return 4;
    case SurfaceKind::kCylinder: return 5;
    case SurfaceKind::kCone: return 6;
    case SurfaceKind::kTorus: return 7;
    case SurfaceKind::kRevolution:
    case SurfaceKind::kFree: break;
  }
  return 8;
}

std::optional<AnalyticSurface> guess_sphere(std::span<const Vec3> points) {
  const Vec3 mean = mean_of(points);
  Matrix<3> a{};
  Vec3 b;
  double s = 0;
  for (const Vec3& p : points) {
    const Vec3 q = p - mean;
    const double square = norm_squared(q);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) a[i][j] += 2 * q[i] * q[j];
      b[i] += square * q[i];
    }
    s += square;
  }
  const std::optional<Vec3> c = solve3(a, b);
  if (!c) return std::nullopt;
  AnalyticSurface sphere;
  sphere.kind = SurfaceKind::kSphere;
  sphere.origin = mean + *c;
  sphere.radius = std::sqrt(s / static_cast<double>(points.size()) + norm_squared(*c));
  return sphere;
}

std::optional<AnalyticSurface> guess_cylinder(std::span<const Vec3> points, const Vec3& axis) {
  const Vec3 x = unit_across(axis), y = cross(axis, x), mean = mean_of(points);
  const std::optional<Circle> circle = guess_circle(points, [&](const Vec3& p) {
    return Vec2{dot(p - mean, x), dot(p - mean, y)};
  });
  if (!circle) return std::nullopt;
  return AnalyticSurface{SurfaceKind::kCylinder, mean + circle->centre.x * x + circle->centre.y * y, axis,
                         circle->radius};
}

std::optional<AnalyticSurface> guess_cylinder(std::span<const Vec3> points, std::span<const FacetPlace> facets) {
  const Eigen<3> eigen = symmetric_eigen(covariance_of_normals(facets, {}));
  if (!(eigen.values[1] > 1e-12 * eigen.values[2])) return std::nullopt;
  const auto& d = eigen.vectors[0];
  return guess_cylinder(points, normalized({d[0], d[1], d[2]}));
}

std::optional<AnalyticSurface> guess_cone(std::span<const Vec3> points, std::span<const FacetPlace> facets) {
  const Vec3 middle = mean_of(points);
  Matrix<3> a{};
  Vec3 b, mean_normal;
  for (const FacetPlace& f : facets) {
    const double offset = dot(f.normal, f.middle - middle);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) a[i][j] += f.normal[i] * f.normal[j];
      b[i] += offset * f.normal[i];
    }
    mean_normal += f.normal;
  }
  mean_normal = (1 / static_cast<double>(facets.size())) * mean_normal;
  const std::optional<Vec3> apex = solve3(a, b);
  if (!apex) return std::nullopt;
  const Eigen<3> eigen = symmetric_eigen(covariance_of_normals(facets, mean_normal));
  const auto& d = eigen.vectors[0];
  Vec3 axis = normalized({d[0], d[1], d[2]});
  if (dot(axis, *apex) > 0) axis = -axis;  // The axis points from the apex to the points.
  double sum_r = 0, sum_z = 0;
  for (const Vec3& p : points) {
    const Vec3 q = p - middle - *apex;
    const double z = dot(q, axis);
    sum_z += z;
    sum_r += norm(q - z * axis);
  }
  if (!(sum_r > 0) || !(sum_z > 0)) return std::nullopt;
  AnalyticSurface cone;
  cone.kind = SurfaceKind::kCone;
  cone.origin = middle + *apex;
  cone.axis = axis;
  cone.half_angle = std::atan2(sum_r, sum_z);
  return cone;
}

std::optional<AnalyticSurface> guess_torus(std::span<const Vec3> points, const Vec3& origin, const Vec3& axis) {
  const std::optional<Circle> circle = guess_circle(points, [&](const Vec3& p) {
    const Vec3 q = p - origin;
    const double z = dot(q, axis);
    return Vec2{norm(q - z * axis), z};
  });
  if (!circle) return std::nullopt;
  AnalyticSurface torus;
  torus.kind = SurfaceKind::kTorus;
  torus.axis = axis;
  torus.origin = origin + circle->centre.y * axis;
  torus.radius = circle->centre.x;
  torus.minor_radius = circle->radius;
  return torus;
}

std::optional<AnalyticSurface> guess_torus(std::span<const Vec3> points, std::span<const FacetPlace> facets) {
  // A line through m along n meets the axis with direction a and moment b = o x a if b . n + a . (m x n) = 0.
  const Vec3 middle = mean_of(points);
  double size = 0;
  for (const FacetPlace& f : facets) size = std::max(size, norm(f.middle - middle));
  if (!(size > 0)) return std::nullopt;
  Matrix<6> sum{};
  for (const FacetPlace& f : facets) {
    const Vec3 moment = cross((1 / size) * (f.middle - middle), f.normal);
    const std::array<double, 6> line{moment.x, moment.y, moment.z, f.normal.x, f.normal.y, f.normal.z};
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j) sum[i][j] += line[i] * line[j];
  }
  const Eigen<6> eigen = symmetric_eigen(sum);
  const auto& e = eigen.vectors[0];
  const Vec3 a{e[0], e[1], e[2]}, b{e[3], e[4], e[5]};
  const double length = norm_squared(a);
  if (!(length > 1e-6)) return std::nullopt;
  // The point of the axis that is nearest to the middle.
  const Vec3 origin = middle + (size / length) * cross(a, b);
  return guess_torus(points, origin, normalized(a));
}

std::optional<AnalyticSurface> fit_from(const AnalyticSurface& start, std::span<const Vec3> points,
                                        const FitGoal& goal) {
  const Vec3 middle = mean_of(points);
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, norm_squared(p - middle));
  if (!(size > 0)) return std::nullopt;
  const double scale = std::ldexp(1.0, -std::ilogb(std::sqrt(size)));
  AnalyticSurface from = start;
  // A cone's axis points into it.
  if (goal.is_canonical && start.kind != SurfaceKind::kCone) from.axis = canonical_direction(start.axis);
  Parameters at = parameters_of(from, middle, scale);
  if (goal.is_canonical) at = rounded(at, scale * middle);
  const std::size_t n = at.count();
  const auto cost_at = [&](double distance) {
    return static_cast<double>(points.size()) * scale * distance * scale * distance;
  };
  const double good = cost_at(goal.good), hopeless = cost_at(goal.hopeless);
  Normal sums = sums_of(at, points, scale);
  double damping = 1e-9;
  constexpr int kPatience = 2;
  for (int i = 0; i < goal.max_steps && sums.cost > good; ++i) {
    Matrix<kMaxParameters> matrix = sums.matrix;
    for (std::size_t k = 0; k < n; ++k) matrix[k][k] += damping * matrix[k][k] + 1e-300;
    Gradient step = sums.right;
    if (!solve_symmetric(matrix, step, n)) {
      damping = std::max(1e-6, 100 * damping);
      if (damping > 1e6) break;
      continue;
    }
    if (goal.control != nullptr) goal.control->check();
    const Parameters next = moved(at, step);
    const Normal after = sums_of(next, points, scale);
    const bool is_settled = std::fabs(sums.cost - after.cost) <= goal.settled * sums.cost || after.cost <= 1e-31;
    // A fit that will succeed converges fast near its end.
    if (i >= kPatience && after.cost > hopeless && after.cost > 0.1 * sums.cost) return std::nullopt;
    if (after.cost < sums.cost) {
      at = next;
      sums = after;
      if (is_settled) break;
      damping = std::max(1e-12, 0.1 * damping);
    } else {
      if (is_settled || damping > 1e6) break;
      damping = std::max(1e-6, 30 * damping);
    }
  }
  if (sums.cost > hopeless) return std::nullopt;
  return surface_of(at, scale);
}

}  // namespace remesh
