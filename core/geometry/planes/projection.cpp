#include "core/geometry/planes/projection.h"

#include <algorithm>
#include <cmath>

#include "core/base/stoppable.h"

namespace remesh {
namespace {

/// Edges whose length differs from that of the longest one by at most this fraction count as equally long.
constexpr double kEquallyLong = 1e-9;

/// The length of the longest edge.
double longest_of(std::span<const Edge3> edges) {
  double squared = 0;
  for (const Edge3& e : edges) squared = std::max(squared, norm_squared(e.to - e.from));
  if (squared > 0x1p-900 && squared < 0x1p1000) return std::sqrt(squared);
  double longest = 0;
  for (const Edge3& e : edges) longest = std::max(longest, norm(e.to - e.from));
  return longest;
}

Vec3 dominant_edge(std::span<const Edge3> edges) {
  // There may be a million small patches, and a square root takes as long as all else here. So an edge that is clearly
  // shorter is told by its square.
  const double longest = longest_of(edges), least = longest * (1 - kEquallyLong);
  const double clearly_less = least * least * (1 - kEquallyLong);
  Vec3 from, to;
  bool is_found = false;
  for (const Edge3& e : edges) {
    const Vec3 way = e.to - e.from;
    if (norm_squared(way) < clearly_less || norm(way) < least) continue;
    const auto [low, high] = std::minmax(e.from, e.to);
    if (!is_found || low < from || (low == from && high < to)) {
      from = low;
      to = high;
      is_found = true;
    }
  }
  return to - from;
}

/// The part of `direction` that is orthogonal to `normal`, as a unit vector; null if the two are (nearly) parallel.
Vec3 orthogonal_part(const Vec3& direction, const Vec3& normal) {
  const Vec3 unit = normalized(direction);
  const Vec3 part = unit - dot(unit, normal) * normal;
  const double length = norm(part);
  if (length < 1e-3) return {};
  // The part may be short, and then its rounding errors are large relative to its length. So `first` may be slightly
  // off the plane that is orthogonal to `normal`. Its component along `normal` is therefore subtracted again. This time
  // the vector has length one, so the errors stay as small as its rounding.
  const Vec3 first{part.x / length, part.y / length, part.z / length};
  return normalized(first - dot(first, normal) * normal);
}

double round_to(double x, double grid) { return std::nearbyint(x / grid) * grid; }

}  // namespace

Frame make_frame(const Vec3& normal, const Vec3& origin, std::span<const Vec3> points, std::span<const Edge3> edges,
                 ReferenceAxis axis, const Vec3& direction, double grid) {
  Frame frame;
  frame.origin = origin;
  frame.normal = normal;
  frame.grid = grid;
  Vec3 wanted{1, 0, 0};
  if (axis == ReferenceAxis::kGiven) wanted = direction;
  if (axis == ReferenceAxis::kDominantEdge) wanted = dominant_edge(edges);
  frame.x_axis = orthogonal_part(wanted, normal);
  for (const Vec3& next : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}})
    if (frame.x_axis == Vec3{}) frame.x_axis = orthogonal_part(next, normal);
  frame.y_axis = cross(normal, frame.x_axis);

  double reach = 0;
  for (const Vec3& p : points)
    reach = std::max({reach, std::fabs(dot(p - origin, frame.x_axis)), std::fabs(dot(p - origin, frame.y_axis))});
  int exponent = 0;
  std::frexp(reach, &exponent);
  frame.scale = std::ldexp(1.0, exponent);
  return frame;
}

Vec2 to_plane(const Frame& frame, const Vec3& point) {
  const Vec3 d = point - frame.origin;
  return {round_to(dot(d, frame.x_axis) / frame.scale, frame.grid),
          round_to(dot(d, frame.y_axis) / frame.scale, frame.grid)};
}

Vec3 to_space(const Frame& frame, Vec2 uv) {
  return frame.origin + (frame.scale * uv.x) * frame.x_axis + (frame.scale * uv.y) * frame.y_axis;
}

std::vector<Vec2> lay_out_polygon(std::span<const Vec3> points, const Vec3& centre, const Vec3& normal,
                                  RunControl& control) {
  const std::size_t n = points.size();
  std::vector<Edge3> edges(n);
  StopCheck check(control);
  for (std::size_t i = 0; i < n; ++i) {
    check();
    edges[i] = {points[i], points[(i + 1) % n]};
  }
  const Frame frame = make_frame(normal, centre, points, edges, ReferenceAxis::kDominantEdge, {}, kFineGrid);
  std::vector<Vec2> uv(n);
  for (std::size_t i = 0; i < n; ++i) {
    check();
    uv[i] = to_plane(frame, points[i]);
  }
  return uv;
}

Vec3 newell_normal(std::span<const Vec3> loop) {
  Vec3 sum;
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) sum += cross(loop[i] - loop[0], loop[i + 1] - loop[0]);
  return sum;
}

}  // namespace remesh
