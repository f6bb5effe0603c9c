#include "core/patches/charts/rulings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/bisection.h"
#include "core/base/stoppable.h"
#include "core/geometry/surfaces/surface_map.h"

namespace remesh {
namespace {

using Around = SurfaceMap::Around;
using Pair = std::array<std::uint32_t, 2>;

/// Vertices are on one ruling if the distance between their rulings is at most this part of the widest strip.
constexpr double kSameRuling = 0.05;
/// The cosine of the smallest angle that a ruling may make with a side. Triangles in a sharper corner would be small.
constexpr double kMaxCosine = 0.5 * (1 + 1e-6);

/// A vertex of the outline, by its place around the axis and along it.
struct OnAxis {
  Around at;
  std::uint32_t vertex;
};

/// Returns the largest turn around the axis that an edge may have where the surface is widest.
double widest_turn(const CurvedChart& chart, double way) {
  return largest_allowed(std::numbers::pi / 2, [&](double turn) {
    const SpacePoint a = chart.space_point(chart.map().point(Around{-turn / 2, way}));
    const SpacePoint b = chart.space_point(chart.map().point(Around{turn / 2, way}));
    return chart.is_bent(a, b);
  });
}

}  // namespace

std::vector<Pair> find_rulings(const CurvedChart& chart, const CurvedOutline& outline, RunControl& control) {
  std::vector<Pair> rulings;
  const SurfaceKind kind = chart.map().shape().kind;
  // In a squeezed plane, edges run along rulings without further constraints.
  if ((kind != SurfaceKind::kCylinder && kind != SurfaceKind::kCone) || chart.map().is_squeezed()) return rulings;
  StopCheck check(control);
  std::vector<OnAxis> vertices;
  vertices.reserve(outline.positions.size());
  double largest = -1, way_of_largest = 0;
  for (std::uint32_t v = 0; v < outline.positions.size(); ++v) {
    check();
    const Vec3& position = outline.positions[v];
    // Near the apex of a cone, rulings are too close to each other.
    if (chart.space_point(position).is_near_apex) continue;
    const Around at = chart.map().around(position);
    if (!std::isfinite(at.way)) continue;
    vertices.push_back({at, v});
    const double radius = chart.map().radius(position);
    if (!(radius > largest)) continue;
    largest = radius;
    way_of_largest = at.way;
  }
  if (vertices.empty()) return rulings;
  const double same = kSameRuling * widest_turn(chart, way_of_largest);

  // Each side is listed at both of its ends.
  std::vector<Pair> sides(outline.sides.begin(), outline.sides.end());
  for (const auto& [a, b] : outline.sides) sides.push_back({b, a});
  sort_stoppable(sides.begin(), sides.end(), control);
  const auto is_sharp = [&](std::uint32_t from, std::uint32_t to) {
    const Vec2 ruling = outline.places[to] - outline.places[from];
    for (auto side = std::lower_bound(sides.begin(), sides.end(), Pair{from, 0});
         side != sides.end() && (*side)[0] == from; ++side) {
      check();
      const Vec2 way = outline.places[(*side)[1]] - outline.places[from];
      if (dot(ruling, way) > kMaxCosine * norm(ruling) * norm(way)) return true;
    }
    return false;
  };

  const auto by_angle = [](const OnAxis& a, const OnAxis& b) {
    return a.at.angle != b.at.angle ? a.at.angle < b.at.angle : a.at.way < b.at.way;
  };
  sort_stoppable(vertices.begin(), vertices.end(), control, by_angle);
  for (std::size_t begin = 0, end = 0; begin < vertices.size(); begin = end) {
    end = begin + 1;
    while (end < vertices.size() && vertices[end].at.angle - vertices[end - 1].at.angle <= same) ++end;
    const auto first = vertices.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = vertices.begin() + static_cast<std::ptrdiff_t>(end);
    sort_stoppable(first, last, control, [](const OnAxis& a, const OnAxis& b) {
      return a.at.way != b.at.way ? a.at.way < b.at.way : a.at.angle < b.at.angle;
    });
    for (std::size_t i = begin + 1; i < end; ++i) {
      const std::uint32_t a = vertices[i - 1].vertex, b = vertices[i].vertex;
      if (std::fabs(vertices[i].at.angle - vertices[i - 1].at.angle) > same) continue;
      if (!is_sharp(a, b) && !is_sharp(b, a)) rulings.push_back({a, b});
    }
  }
  return rulings;
}

}  // namespace remesh
