#include "core/verify/model/curved_shape.h"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/base/largest_coordinate.h"
#include "core/verify/model/torus_face.h"

namespace remesh::verification {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

double length(Vec2 a) { return std::sqrt(dot(a, a)); }

/// True if a polygon contains the origin. If the polygon passes through the origin up to rounding, either answer may
/// result.
template <class At>
bool contains_origin(std::size_t n, const At& at) {
  bool is_inside = false;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 a = at(i), b = at(i + 1 == n ? 0 : i + 1);
    if ((a.y > 0) == (b.y > 0)) continue;
    if ((cross(a, b) > 0) == (b.y > a.y)) is_inside = !is_inside;
  }
  return is_inside;
}

/// True if direction m lies in the sector of less than half a turn between a and b.
bool is_in_sector(Vec2 m, Vec2 a, Vec2 b) {
  const double turn = cross(a, b), to = cross(a, m), from = cross(m, b);
  return turn > 0 ? to >= 0 && from >= 0 : turn < 0 && to <= 0 && from <= 0;
}

/// Twice the area vector of a polygon, and the sum of the products that went into it.
struct AreaVector {
  Vec3 twice;
  double magnitude = 0;
};
AreaVector area_of(std::span<const Vec3> corners) {
  AreaVector area;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Vec3 a = corners[i - 1] - corners[0], b = corners[i] - corners[0];
    area.twice += cross(a, b);
    area.magnitude += largest_coordinate(a) * largest_coordinate(b);
  }
  return area;
}

/// The solid angle of a triangle seen from the origin. It is positive if the corners turn counter-clockwise for
/// someone outside.
/// Source: van Oosterom, Strackee, The solid angle of a plane triangle, IEEE Trans. Biomed. Eng. 1983.
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = norm(a), lb = norm(b), lc = norm(c);
  return 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

double CurvedShape::Local::radius() const { return length(across); }

CurvedShape::CurvedShape(const AnalyticSurface& claimed, double scale)
    : kind_(claimed.kind),
      origin_(scale * claimed.origin),
      axis_(claimed.axis),
      radius_(scale * claimed.radius),
      minor_radius_(scale * claimed.minor_radius),
      half_angle_(claimed.half_angle) {
  if (kind_ == SurfaceKind::kSphere) axis_ = {0, 0, 1};
  // The axis of space at the largest angle to the surface's axis gives the first direction across it.
  const Vec3 a{std::fabs(axis_.x), std::fabs(axis_.y), std::fabs(axis_.z)};
  const Vec3 far = a.x <= a.y && a.x <= a.z ? Vec3{1, 0, 0} : a.y <= a.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  x_ = normalized(cross(far, axis_));
  y_ = cross(axis_, x_);
  if (kind_ == SurfaceKind::kCone) {
    cos_ = std::cos(half_angle_);
    sin_ = std::sin(half_angle_);
  }
  // The coordinates of points are at most 1. Each distance takes about ten roundings of numbers of this size.
  noise_ = 0x1p-49 * (1 + largest_coordinate(origin_) + std::fabs(radius_) + minor_radius_);
}

bool CurvedShape::is_sound() const {
  const bool has_axis = std::fabs(norm(axis_) - 1) <= 1e-12;
  if (!is_finite(origin_) || !has_axis || !std::isfinite(noise_)) return false;
  switch (kind_) {
    case SurfaceKind::kCylinder:
    case SurfaceKind::kSphere: return radius_ > 0;
    case SurfaceKind::kCone: return half_angle_ > 0 && half_angle_ < std::numbers::pi / 2;
    case SurfaceKind::kTorus: return minor_radius_ > 0 && radius_ + minor_radius_ > 0;
    default: return false;
  }
}

bool CurvedShape::is_compact() const {
  // The outer part of a torus that crosses itself ends at its axis, where it has no nearest points.
  return kind_ == SurfaceKind::kSphere || (kind_ == SurfaceKind::kTorus && minor_radius_ < radius_);
}

double CurvedShape::area() const {
  constexpr double kPi = std::numbers::pi;
  return kind_ == SurfaceKind::kSphere ? 4 * kPi * radius_ * radius_ : 4 * kPi * kPi * radius_ * minor_radius_;
}

double CurvedShape::largest_depth() const {
  if (kind_ == SurfaceKind::kCone) return kInfinite;
  return (kind_ == SurfaceKind::kTorus ? minor_radius_ : radius_) / 2;
}

CurvedShape::Local CurvedShape::local(const Vec3& p) const {
  const Vec3 d = p - origin_;
  return {dot(d, axis_), {dot(d, x_), dot(d, y_)}};
}

double CurvedShape::distance(const Local& p) const {
  switch (kind_) {
    case SurfaceKind::kSphere: return std::sqrt(dot(p.across, p.across) + p.height * p.height) - radius_;
    case SurfaceKind::kTorus: return length({p.radius() - radius_, p.height}) - minor_radius_;
    default: return p.radius() * cos_ - p.height * sin_ - (kind_ == SurfaceKind::kCylinder ? radius_ : 0);
  }
}
double CurvedShape::distance(const Vec3& p) const { return distance(local(p)); }

double CurvedShape::depth_between(const Vec3& a, const Vec3& b) const {
  const double middle = distance(a + 0.5 * (b - a));
  if (kind_ == SurfaceKind::kTorus) return std::fabs(middle) + norm(b - a) / 2;
  // The signed distance is convex on a line. So its max is at an end, and its min is at least twice the value in the
  // middle minus that max.
  const double high = std::max(distance(a), distance(b));
  return std::max(std::fabs(high), std::fabs(2 * middle - high)) + noise_;
}

Vec3 CurvedShape::normal(const Vec3& p) const {
  if (kind_ == SurfaceKind::kSphere) return normalized(p - origin_);
  const Local at = local(p);
  const double r = at.radius();
  if (!(r > 0)) return {};
  const Vec3 outwards = (at.across.x / r) * x_ + (at.across.y / r) * y_;
  if (kind_ == SurfaceKind::kTorus) return normalized((r - radius_) * outwards + at.height * axis_);
  return cos_ * outwards - sin_ * axis_;
}

Vec3 CurvedShape::direction_around(const Vec3& p) const {
  if (kind_ == SurfaceKind::kSphere) return {};
  const Local at = local(p);
  return normalized(-at.across.y * x_ + at.across.x * y_);
}

double CurvedShape::largest_radius() const {
  if (kind_ == SurfaceKind::kCone) return 0;
  return kind_ == SurfaceKind::kTorus ? radius_ + minor_radius_ : radius_;
}

RuledPoint CurvedShape::ruled(const Vec3& p) const {
  const Local at = local(p);
  const double radius = at.radius();
  return {at.height * cos_ + radius * sin_, radius, at.across};
}

double CurvedShape::turning_length(const Vec3& way) const {
  return is_ruled() ? length({dot(way, x_), dot(way, y_)}) : norm(way);
}

double CurvedShape::turn_rate(const Vec3& centre, double radius) const {
  const Local at = local(centre);
  const double to_axis = at.radius();
  double nearest = to_axis;
  if (kind_ == SurfaceKind::kSphere) nearest = std::sqrt(dot(at.across, at.across) + at.height * at.height);
  if (kind_ == SurfaceKind::kTorus) nearest = std::min(to_axis, length({to_axis - radius_, at.height}));
  nearest -= radius + noise_;
  return nearest > 0 ? 1 / nearest : kInfinite;
}

/// The smallest distance on the edge from a to b. On a line it is convex, so its min is at an end or where its
/// derivative is 0.
double CurvedShape::lowest_on_edge(const Local& a, const Local& b) const {
  const Vec2 way = b.across - a.across;
  const double square = dot(way, way), slope = (b.height - a.height) * sin_ / cos_;
  if (!(square > slope * slope)) return kInfinite;
  const double past = cross(a.across, way);
  const double from_foot = slope * std::sqrt(past * past / (square * square * (square - slope * slope)));
  const double t = std::clamp(from_foot - dot(a.across, way) / square, 0.0, 1.0);
  return distance(Local{a.height + t * (b.height - a.height), a.across + t * way});
}

CurvedFace CurvedShape::read(std::span<Vec3> corners, double snap, const Range& known) const {
  double snapped = 0;
  if (kind_ == SurfaceKind::kCone)
    for (Vec3& p : corners) {
      const double off = norm(p - origin_);
      // A sharp cone that is cut off by the tolerance ends farther from its apex by this.
      if (!(off * sin_ <= snap)) continue;
      snapped = std::max(snapped, off);
      p = origin_;
    }
  const AreaVector area = area_of(corners);
  const double twice_area = norm(area.twice);
  const Vec3 normal = normalized(area.twice);
  CurvedFace face = kind_ == SurfaceKind::kSphere  ? read_sphere(corners, normal)
                    : kind_ == SurfaceKind::kTorus ? read_torus(corners, normal, known)
                                                   : read_ruled(corners, normal);
  double off_plane = 0;
  if (corners.size() > 3)
    for (const Vec3& p : corners) off_plane = std::max(off_plane, std::fabs(dot(p - corners[0], normal)));
  face.distance = face.distance.widened(off_plane + noise_);
  face.snapped = snapped;
  // The normal of a narrow face is known less exactly.
  face.facing = twice_area > 0 ? face.facing.widened(0x1p-49 * area.magnitude / twice_area) : Range{-1, 1};
  if (!is_compact()) face.area = {0, 0};
  return face;
}

/// Measures a face at a cylinder or cone. Let rho be the distance of a point from the axis and h its height along it.
/// The distance from the surface is rho cos a - h sin a (minus the radius of a cylinder), which is convex. So it is
/// largest at a corner. A gradient of this function has length 1, so it is lowest inside a flat face only if the face
/// is parallel to the surface there, and then it is as low on an edge, too; or on the axis, where it has no gradient.
/// The cosine between the normals depends only on the direction in which a point lies from the axis. So its extremes
/// are at corners, or where that direction is along or against the part of the face's normal across the axis.
CurvedFace CurvedShape::read_ruled(std::span<const Vec3> corners, const Vec3& normal) const {
  CurvedFace face;
  const Vec2 across{dot(normal, x_), dot(normal, y_)};
  const double largest = length(across);
  Range turn;
  bool is_at_apex = false, is_around_axis = false;
  double highest = -kInfinite, lowest = kInfinite;
  Local a = local(corners.back());
  for (const Vec3& corner : corners) {
    const Local b = local(corner);
    highest = std::max(highest, b.height);
    lowest = std::min(lowest, b.height);
    face.distance.add(distance(b));
    face.distance.low = std::min(face.distance.low, lowest_on_edge(a, b));
    const double of_a = a.radius(), of_b = b.radius();
    if (of_b > 0) turn.add(dot(across, b.across) / of_b);
    if (of_a > 0 && of_b > 0) {
      if (is_in_sector(across, a.across, b.across)) turn.high = largest;
      if (is_in_sector(-1 * across, a.across, b.across)) turn.low = -largest;
      const bool is_through_axis =
          dot(a.across, b.across) < 0 && std::fabs(cross(a.across, b.across)) <= noise_ * length(b.across - a.across);
      is_around_axis = is_around_axis || is_through_axis;
    }
    is_at_apex = is_at_apex || !(of_b > 0);
    a = b;
  }
  // A face with a corner at the apex does not contain the axis inside.
  is_around_axis =
      is_around_axis ||
      (!is_at_apex && contains_origin(corners.size(), [&](std::size_t i) { return local(corners[i]).across; }));
  if (is_around_axis) face.distance.add(kind_ == SurfaceKind::kCylinder ? -radius_ : -highest * sin_);
  // Points behind the apex have no nearest point on the cone but the apex.
  const bool is_behind = kind_ == SurfaceKind::kCone && lowest < 0;
  if (is_around_axis || is_behind || !(turn.low <= turn.high))
    face.facing = {-1, 1};
  else
    face.facing = {cos_ * turn.low - sin_ * dot(normal, axis_), cos_ * turn.high - sin_ * dot(normal, axis_)};
  return face;
}

/// Measures a face at a sphere. The centre's height over the plane of the face decides in which direction the face
/// looks.
CurvedFace CurvedShape::read_sphere(std::span<const Vec3> corners, const Vec3& normal) const {
  CurvedFace face;
  double nearest = kInfinite;
  Vec3 a = corners.back() - origin_;
  for (const Vec3& corner : corners) {
    const Vec3 b = corner - origin_, way = b - a;
    const double square = norm_squared(way), to_b = norm(b);
    const double t = square > 0 ? std::clamp(-dot(a, way) / square, 0.0, 1.0) : 0;
    nearest = std::min({nearest, to_b, norm(a + t * way)});
    face.distance.add(to_b - radius_);
    if (to_b > 0) face.facing.add(dot(normal, b) / to_b);
    a = b;
  }
  // The centre's nearest point of the plane may be inside the face. It is looked for along the axis of space which is
  // nearest to the normal.
  const double height = dot(corners[0] - origin_, normal);
  const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
  const int along = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
  const Vec3 foot = origin_ + height * normal;
  const bool is_over = contains_origin(corners.size(), [&](std::size_t i) {
    const Vec3 d = corners[i] - foot;
    return Vec2{d[(along + 1) % 3], d[(along + 2) % 3]};
  });
  if (is_over) nearest = std::min(nearest, std::fabs(height));
  face.distance.add(nearest - radius_);
  if (!(face.facing.low <= face.facing.high)) face.facing = {-1, 1};
  double angle = 0;
  for (std::size_t i = 2; i < corners.size(); ++i)
    angle += solid_angle(corners[0] - origin_, corners[i - 1] - origin_, corners[i] - origin_);
  face.area = {std::fabs(angle) * radius_ * radius_, std::fabs(angle) * radius_ * radius_};
  return face;
}

/// Measures a face at a torus, in coordinates about its axis.
CurvedFace CurvedShape::read_torus(std::span<const Vec3> corners, const Vec3& normal, const Range& known) const {
  std::vector<Vec3> centred;
  centred.reserve(corners.size());
  for (const Vec3& p : corners) {
    const Local at = local(p);
    centred.push_back({at.across.x, at.across.y, at.height});
  }
  return read_torus_face({radius_, minor_radius_, noise_}, centred,
                         {dot(normal, x_), dot(normal, y_), dot(normal, axis_)}, known);
}

}  // namespace remesh::verification
