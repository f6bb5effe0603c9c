#include "core/verify/model/torus_face.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace remesh::verification {
namespace {

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
  // The nearest point must be on the same side of the axis.
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

}  // namespace

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

}  // namespace remesh::verification
