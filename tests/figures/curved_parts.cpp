#include "tests/figures/curved_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <span>
#include <vector>

namespace remesh::figures {
namespace {

/// Polygons that are welded as they are added.
class Polygons {
 public:
  /// Adds a polygon. Corners in one place become one, and what has fewer than three is left out.
  void add(std::span<const Vec3> corners) {
    std::vector<VertexId> polygon;
    for (const Vec3& p : corners) {
      const VertexId v = vertex_at(p);
      if (polygon.empty() || polygon.back() != v) polygon.push_back(v);
    }
    if (polygon.size() > 1 && polygon.front() == polygon.back()) polygon.pop_back();
    if (polygon.size() < 3) return;
    for (const VertexId v : polygon) mesh_.corners.push_back(v);
    mesh_.face_begin.push_back(static_cast<std::uint32_t>(mesh_.corners.size()));
  }
  void add(std::initializer_list<Vec3> corners) { add(std::span(corners.begin(), corners.size())); }

  const PolygonMesh& mesh() const { return mesh_; }

 private:
  VertexId vertex_at(const Vec3& p) {
    const auto rounded = [](double x) { return std::round(x * 1e6) / 1e6 + 0.0; };
    const Vec3 at{rounded(p.x), rounded(p.y), rounded(p.z)};
    const auto [entry, is_new] = vertex_of_.try_emplace(at, mesh_.positions.size());
    if (is_new) mesh_.positions.push_back(at);
    return entry->second;
  }

  PolygonMesh mesh_;
  std::map<Vec3, VertexId> vertex_of_;
};

Vec2 on_circle(double radius, double angle_deg) {
  const double angle = angle_deg * std::numbers::pi / 180;
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// A line of points (height, radius) that turns around an axis.
using Outline = std::vector<Vec2>;

void append_arc(Outline& outline, Vec2 centre, double radius, double from_deg, double to_deg, int steps) {
  for (int i = 0; i <= steps; ++i)
    outline.push_back(centre + on_circle(radius, from_deg + (to_deg - from_deg) * i / steps));
}

std::vector<Vec3> lifted(const std::vector<Vec2>& loop, double z) {
  std::vector<Vec3> result;
  for (const Vec2& p : loop) result.push_back({p.x, p.y, z});
  return result;
}

/// Adds the sides of a prism over a loop, seen from outside if the loop runs counter-clockwise.
void add_sides(Polygons& part, const std::vector<Vec2>& loop, double height) {
  const std::vector<Vec3> low = lifted(loop, 0), high = lifted(loop, height);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::size_t next = (i + 1) % loop.size();
    part.add({low[i], low[next], high[next], high[i]});
  }
}

}  // namespace

Vec3 turned_point(double height, double radius, double angle_deg) {
  const Vec2 across = on_circle(radius, angle_deg);
  return {across.x, height, across.y};
}

PolygonMesh make_turned_part() {
  Outline outline{{22, 0}, {22, 8}, {0, 8}, {0, 13}, {5, 18}};
  append_arc(outline, {39, 24}, 6, -90, 0, 5);  // the fillet
  append_arc(outline, {49, 29}, 4, 180, 90, 4);
  outline.push_back({56, 33});
  constexpr int kBands = 10;
  for (int i = 0; i <= kBands; ++i) {
    const double x = static_cast<double>(i) / kBands;
    outline.push_back({56 + 50 * x, 14 - 5 * x + 3.5 * std::sin(1.5 * std::numbers::pi * x)});
  }
  // The ball ends on the axis. Its first circle is where the grip ends.
  constexpr double kBall = 14;
  const double grip_end = outline.back().y, ball_angle = 180 / std::numbers::pi * std::asin(grip_end / kBall);
  const double centre = outline.back().x + std::sqrt(kBall * kBall - grip_end * grip_end);
  append_arc(outline, {centre, 0}, kBall, 180 - ball_angle, 0, 10);
  outline.back().y = 0;

  Polygons part;
  for (std::size_t i = 0; i + 1 < outline.size(); ++i)
    for (int k = 0; k < kTurnedSides; ++k) {
      const double a = 360.0 * k / kTurnedSides, b = 360.0 * ((k + 1) % kTurnedSides) / kTurnedSides;
      const Vec2 low = outline[i], high = outline[i + 1];
      part.add({turned_point(low.x, low.y, a), turned_point(high.x, high.y, a), turned_point(high.x, high.y, b),
                turned_point(low.x, low.y, b)});
    }
  return part.mesh();
}

PolygonMesh make_flattened_shaft() {
  constexpr int kSides = 40, kFlatBegin = 33, kFlatEnd = 40;  // The flat takes the place of seven facets.
  constexpr double kRadius = 10, kHeight = 26;
  std::vector<Vec2> loop;
  for (int k = 0; k < kSides; ++k)
    if (k <= kFlatBegin || k >= kFlatEnd) loop.push_back(on_circle(kRadius, 360.0 * k / kSides));
  Polygons part;
  add_sides(part, loop, kHeight);
  part.add(lifted(loop, kHeight));
  part.add(lifted({loop.rbegin(), loop.rend()}, 0));
  return part.mesh();
}

PolygonMesh make_nut() {
  constexpr double kRadius = 16, kBore = 9, kHeight = 13;
  constexpr int kBoreSides = 32;
  std::vector<Vec2> loop, bore;
  for (int k = 0; k < 6; ++k) loop.push_back(on_circle(kRadius, 60 * k + 15));
  for (int k = 0; k < kBoreSides; ++k) bore.push_back(on_circle(kBore, 15 - 360.0 * k / kBoreSides));
  Polygons part;
  add_sides(part, loop, kHeight);
  add_sides(part, bore, kHeight);
  // The top and the bottom are one polygon each, with a bridge to the bore.
  std::vector<Vec2> top = loop;
  top.push_back(loop.front());
  top.insert(top.end(), bore.begin(), bore.end());
  top.push_back(bore.front());
  part.add(lifted(top, kHeight));
  part.add(lifted({top.rbegin(), top.rend()}, 0));
  return part.mesh();
}

PolygonMesh make_flange(int sides) {
  constexpr double kOuter = 40, kPlate = 8, kBoss = 16, kTop = 24, kChamfer = 4, kBore = 8;
  constexpr double kHole = 4, kHoleCircle = 28, kStartDeg = 20;
  const auto at = [&](double radius, double z, int step) {
    const Vec2 p = on_circle(radius, kStartDeg + 360.0 * (step % sides) / sides);
    return Vec3{p.x, p.y, z};
  };
  Polygons part;
  // A band between two circles around the axis, seen from outside if the second circle is above the first one.
  const auto add_band = [&](double radius, double z, double next_radius, double next_z) {
    for (int k = 0; k < sides; ++k)
      part.add({at(radius, z, k), at(radius, z, k + 1), at(next_radius, next_z, k + 1), at(next_radius, next_z, k)});
  };
  add_band(kOuter, 0, kOuter, kPlate);
  add_band(kBoss, kPlate, kBoss, kTop - kChamfer);
  add_band(kBoss, kTop - kChamfer, kBoss - kChamfer, kTop);
  add_band(kBoss - kChamfer, kTop, kBore, kTop);
  add_band(kBore, kTop, kBore, 0);
  // The top and the bottom of the plate are four polygons each. A bridge leads to the hole in each of them.
  const int eighth = sides / 8;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const int middle = 2 * eighth * quarter + sides;
    const Vec2 centre = on_circle(kHoleCircle, kStartDeg + 90.0 * quarter);
    const auto on_hole = [&](double z, int step) {
      const Vec3 p = at(kHole, z, middle + step + sides);
      return Vec3{centre.x + p.x, centre.y + p.y, z};
    };
    for (const bool is_top : {true, false}) {
      const double z = is_top ? kPlate : 0;
      std::vector<Vec3> polygon;
      for (int k = -eighth; k <= 0; ++k) polygon.push_back(at(kOuter, z, middle + k));
      for (int k = 0; k <= sides; ++k) polygon.push_back(on_hole(z, -k));
      for (int k = 0; k <= eighth; ++k) polygon.push_back(at(kOuter, z, middle + k));
      for (int k = eighth; k >= -eighth; --k) polygon.push_back(at(is_top ? kBoss : kBore, z, middle + k));
      if (!is_top) std::reverse(polygon.begin(), polygon.end());
      part.add(polygon);
    }
    for (int k = 0; k < sides; ++k)
      part.add({on_hole(0, k + 1), on_hole(0, k), on_hole(kPlate, k), on_hole(kPlate, k + 1)});
  }
  return part.mesh();
}

PolygonMesh make_ellipsoid() {
  constexpr int kRings = 14, kSides = 28;
  const auto at = [](int ring, int side) {
    const Vec2 across = on_circle(1, 180.0 * ring / kRings),
               around = on_circle(across.y, 360.0 * (side % kSides) / kSides);
    return Vec3{9 * around.x, 15 * around.y, -12 * across.x};
  };
  Polygons part;
  for (int ring = 0; ring < kRings; ++ring)
    for (int side = 0; side < kSides; ++side)
      part.add({at(ring, side), at(ring, side + 1), at(ring + 1, side + 1), at(ring + 1, side)});
  return part.mesh();
}

PolygonMesh make_stone() {
  constexpr int kSquares = 10;
  // A cube with a grid on each side is blown up.
  const auto at = [](int side, int i, int j) {
    const double u = std::tan((2.0 * i / kSquares - 1) * std::numbers::pi / 4),
                 v = std::tan((2.0 * j / kSquares - 1) * std::numbers::pi / 4);
    const double sign = side % 2 == 0 ? 1 : -1;
    Vec3 p;
    p[side / 2] = sign;
    p[(side / 2 + 1) % 3] = sign * u;
    p[(side / 2 + 2) % 3] = v;
    p = normalized(p);
    const double r =
        10 + 0.7 * std::sin(4 * p.x + 1) * std::sin(5 * p.y + 2) + 0.5 * std::sin(7 * p.z) * std::cos(6 * p.x);
    return Vec3{r * p.x, 1.2 * r * p.y, 0.9 * r * p.z};
  };
  Polygons part;
  for (int side = 0; side < 6; ++side)
    for (int j = 0; j < kSquares; ++j)
      for (int i = 0; i < kSquares; ++i) {
        part.add({at(side, i, j), at(side, i + 1, j), at(side, i + 1, j + 1)});
        part.add({at(side, i, j), at(side, i + 1, j + 1), at(side, i, j + 1)});
      }
  return part.mesh();
}

}  // namespace remesh::figures
