#include "core/verify/model/curved_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/largest_coordinate.h"
#include "core/base/vec.h"
#include "core/verify/model/curved_face.h"

namespace remesh::verification {
namespace {

/// A torus about the z axis, with its centre at the origin.
struct CentredTorus {
  /// Radius of the circle in the middle of the tube. It is negative if the middle of the tube lies beyond the axis,
  /// seen from the tube's surface.
  double radius = 0;
  double minor_radius = 0;  ///< radius of the tube
  double noise = 0;         ///< a bound on the rounding of a distance
};

constexpr double kUnbounded = std::numeric_limits<double>::infinity();
constexpr int kMaxDepth = 5;

/// A piece of the polygon.
struct Piece {
  std::array<Vec3, 3> corners;
  int depth;
};

/// A point relative to the torus: its distances from the axis and from the circle in the middle of the tube, and the
/// place of its nearest point on the tube.
struct Place {
  double from_axis, from_circle;
  double cosine,
      sine;     ///< cosine and sine of the angle on the tube, which is 0 at the torus's largest distance from the axis
  Vec3 normal;  ///< normal of the torus at the nearest point
  Vec3 around_tube, around_axis;
};

Place place_of(const CentredTorus& torus, const Vec3& p) {
  Place at;
  at.from_axis = std::sqrt(p.x * p.x + p.y * p.y);
  const double out = at.from_axis - torus.radius;
  at.from_circle = std::sqrt(out * out + p.z * p.z);
  at.cosine = out / at.from_circle;
  at.sine = p.z / at.from_circle;
  const double x = p.x / at.from_axis, y = p.y / at.from_axis;
  at.normal = {at.cosine * x, at.cosine * y, at.sine};
  at.around_tube = {-at.sine * x, -at.sine * y, at.cosine};
  at.around_axis = {-y, x, 0};
  return at;
}

double distance(const CentredTorus& torus, const Vec3& p) {
  const double out = std::sqrt(p.x * p.x + p.y * p.y) - torus.radius;
  return std::sqrt(out * out + p.z * p.z) - torus.minor_radius;
}

/// A quadratic function of a place in a triangle, which is u of the way to the second corner and v to the third.
struct Quadratic {
  double at_first, u, v, uu, uv, vv;  ///< at_first + u U + v V + (uu U^2 + 2 uv U V + vv V^2) / 2

  double at(double x, double y) const {
    return at_first + u * x + v * y + (uu * x * x + 2 * uv * x * y + vv * y * y) / 2;
  }

  /// The values on a line from a place in a direction, for parameters between 0 and 1.
  void add_edge(double x, double y, double dx, double dy, Range& range) const {
    const double slope = (u + uu * x + uv * y) * dx + (v + uv * x + vv * y) * dy;
    const double bend = uu * dx * dx + 2 * uv * dx * dy + vv * dy * dy;
    range.add(at(x, y));
    const double t = -slope / bend;
    if (t > 0 && t < 1) range.add(at(x + t * dx, y + t * dy));
  }

  /// The smallest and the largest value on the triangle. They are at a corner, or where the function has no slope along
  /// an edge or inside.
  Range range() const {
    Range range;
    add_edge(0, 0, 1, 0, range);
    add_edge(1, 0, -1, 1, range);
    add_edge(0, 1, 0, -1, range);
    const double determinant = uu * vv - uv * uv;
    const double x = (uv * v - vv * u) / determinant, y = (uv * u - uu * v) / determinant;
    if (x > 0 && y > 0 && x + y < 1) range.add(at(x, y));
    return range;
  }
};

/// The ranges in which the measures of a piece lie.
struct Bounds {
  Range distance{-kUnbounded, kUnbounded};
  Range facing{-1, 1};
  Range covered{0, kUnbounded};
};

/// Bounds the distance over a piece that lies in a ball around `centre`. Three bounds hold, and the narrowest counts.
///
/// One comes from the values at the corners. The distance deviates from the plane through them by no more than half of
/// its largest second derivative times the square of the ball's radius (see Waldron, The error in linear interpolation
/// at the vertices of a simplex, SIAM J. Numer. Anal. 1998). The other comes from its Taylor polynomial of second order
/// about the centre, which is quadratic on the piece, and a bound on its third derivative. Along a unit vector w with
/// the parts w_n along the normal, w_t around the tube, w_a around the axis and w_r away from the axis, the second
/// derivative is w_t^2 / d + cos w_a^2 / r with the distances d from the circle and r from the axis. On the line along
/// w, its derivative is
///   -3 (w_t^2 w_n / d^2 + sin w_t w_a^2 / (r d) + cos w_a^2 w_r / r^2),
/// and no product of a square of one part and another part, at right angles to it, exceeds 2 / (3 sqrt 3).
Range bound_distance(const CentredTorus& torus, const Piece& piece, const Vec3& centre, double extent, const Place& at,
                     const Range& at_corners) {
  const auto& p = piece.corners;
  const double to_axis = at.from_axis - extent, to_circle = at.from_circle - extent;
  const double outer = std::min(1.0, std::max(0.0, (at.from_axis + extent - torus.radius) / to_circle));
  const double inner = std::min(1.0, std::max(0.0, (torus.radius - at.from_axis + extent) / to_circle));
  const double up = std::max(1 / to_circle, outer / to_axis), down = inner / to_axis;
  const Range linear{at_corners.low - up * extent * extent / 2, at_corners.high + down * extent * extent / 2};

  const double bend_of_tube = 1 / at.from_circle, bend_of_axis = at.cosine / at.from_axis;
  const Vec3 first = p[0] - centre, u = p[1] - p[0], v = p[2] - p[0];
  const auto bend = [&](const Vec3& a, const Vec3& b) {
    return bend_of_tube * dot(at.around_tube, a) * dot(at.around_tube, b) +
           bend_of_axis * dot(at.around_axis, a) * dot(at.around_axis, b);
  };
  const Quadratic quadratic{at.from_circle - torus.minor_radius + dot(at.normal, first) + bend(first, first) / 2,
                            dot(at.normal, u) + bend(first, u),
                            dot(at.normal, v) + bend(first, v),
                            bend(u, u),
                            bend(u, v),
                            bend(v, v)};
  const double third =
      2 / std::numbers::sqrt3 * (1 / (to_circle * to_circle) + 1 / (to_axis * to_circle) + 1 / (to_axis * to_axis));
  const Range taylor = quadratic.range().widened(third * extent * extent * extent / 6 + torus.noise);
  return {std::max(linear.low, taylor.low), std::min(linear.high, taylor.high)};
}

/// The cosines of all angles that differ from the angle of a cosine by no more than `turn`.
Range turned(double cosine, double turn) {
  if (!(turn < std::numbers::pi / 2)) return {-1, 1};
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double of_turn = std::cos(turn), sine_of_turn = std::sin(turn);
  const double less = cosine * of_turn + sine * sine_of_turn, more = cosine * of_turn - sine * sine_of_turn;
  return {cosine <= -of_turn ? -1 : more, cosine >= of_turn ? 1 : less};
}

Bounds bound_piece(const CentredTorus& torus, const Piece& piece, const Vec3& normal, const Range& at_corners) {
  const auto& p = piece.corners;
  const Vec3 centre = (1.0 / 3) * (p[0] + p[1] + p[2]);
  const double extent =
      std::sqrt(std::max({norm_squared(p[0] - centre), norm_squared(p[1] - centre), norm_squared(p[2] - centre)})) +
      torus.noise;
  Bounds bounds;
  const Place at = place_of(torus, centre);
  const double to_axis = at.from_axis - extent, to_circle = at.from_circle - extent;
  if (!(to_axis > 0 && to_circle > 0)) return bounds;
  bounds.distance = bound_distance(torus, piece, centre, extent, at, at_corners);
  // The bound on normals holds if the point of the torus that is nearest to the piece is on its side of the axis.
  const double out = at.from_axis - extent - torus.radius;
  const double outwards = std::max(-1.0, out / (out > 0 ? at.from_circle + extent : to_circle));
  if (torus.radius + torus.minor_radius * outwards > 0)
    bounds.facing = turned(dot(normal, at.normal), extent / std::min(to_axis, to_circle));
  const double depth = std::max(std::fabs(bounds.distance.low), std::fabs(bounds.distance.high));
  const double area = norm(cross(p[1] - p[0], p[2] - p[0])) / 2;
  const double smallest = std::min(std::fabs(bounds.facing.low), std::fabs(bounds.facing.high));
  const double around = depth / to_axis, minor = torus.minor_radius;
  const bool is_sure = bounds.facing.low * bounds.facing.high > 0;
  bounds.covered.low = is_sure ? std::max(0.0, area * smallest * (1 - around) * minor / (minor + depth)) : 0;
  bounds.covered.high = depth < minor ? area * (1 + around) * minor / (minor - depth) : kUnbounded;
  return bounds;
}

/// Measures a flat polygon against a torus.
/// Input:  `normal` - the unit normal of the polygon; `known` - distances of other faces. The polygon is measured no
///         finer than these require.
/// Output: all of CurvedFace but `snapped`. `distance` may exceed both `known` and the true range by a 64th of their
///         width.
/// Cost:   a triangle is cut into no more than 1,024 pieces.
CurvedFace read_torus_face(const CentredTorus& torus, std::span<const Vec3> corners, const Vec3& normal,
                           const Range& known) {
  CurvedFace face;
  face.area = {0, 0};
  Range sampled = known;
  std::vector<Piece> pieces;
  for (std::size_t i = corners.size() - 1; i > 1; --i) pieces.push_back({{corners[0], corners[i - 1], corners[i]}, 0});
  while (!pieces.empty()) {
    const Piece piece = pieces.back();
    pieces.pop_back();
    const auto& [p, depth] = piece;
    Range at_corners;
    for (const Vec3& q : p) at_corners.add(distance(torus, q));
    sampled.add(at_corners);
    const Bounds bounds = bound_piece(torus, piece, normal, at_corners);
    const double enough = (sampled.high - sampled.low) / 64 + torus.noise;
    const bool is_exact = bounds.distance.low >= sampled.low - enough && bounds.distance.high <= sampled.high + enough;
    const bool is_sure = bounds.facing.low > 0 || bounds.facing.high < 0;
    if ((is_exact && is_sure) || depth == kMaxDepth) {
      face.distance.add(bounds.distance);
      face.facing.add(bounds.facing);
      face.area.low += bounds.covered.low;
      face.area.high += bounds.covered.high;
      continue;
    }
    const Vec3 ab = 0.5 * (p[0] + p[1]), bc = 0.5 * (p[1] + p[2]), ca = 0.5 * (p[2] + p[0]);
    pieces.push_back({{ab, bc, ca}, depth + 1});
    pieces.push_back({{ca, bc, p[2]}, depth + 1});
    pieces.push_back({{ab, p[1], bc}, depth + 1});
    pieces.push_back({{p[0], ab, ca}, depth + 1});
  }
  return face;
}

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
