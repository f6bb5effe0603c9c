#include "core/geometry/surfaces/surface_integral.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace remesh {
namespace {

const Vec3 kCentre{1, -2, 3};
const Vec3 kX{0, 1, 0}, kY{0, 0, 1}, kZ{1, 0, 0};

/// A place on a surface by two parameters. The first one goes around the axis.
using PointAt = std::function<Vec3(double u, double v)>;

Vec3 around(double radius, double angle, double height) {
  return kCentre + radius * (std::cos(angle) * kX + std::sin(angle) * kY) + height * kZ;
}

/// Adds a straight way in the plane of the parameters, cut into pieces.
void add_way(const PointAt& place, Vec2 from, Vec2 to, int pieces, SurfaceIntegral& integral) {
  for (int i = 0; i < pieces; ++i) {
    SurfaceIntegral::Curve curve;
    for (std::size_t k = 0; k < curve.size(); ++k) {
      const Vec2 q = from + (i + SurfaceIntegral::places()[k]) / pieces * (to - from);
      curve[k] = place(q.x, q.y);
    }
    integral.add(curve);
  }
}

/// Returns the integral over the place's rectangle of parameters.
SurfaceIntegral over(const AnalyticSurface& shape, const PointAt& place, Vec2 low, Vec2 high, int pieces,
                     double unit = 1) {
  const Vec2 middle = 0.5 * (low + high);
  SurfaceIntegral integral(shape, place(middle.x, middle.y), unit);
  add_way(place, low, {high.x, low.y}, pieces, integral);
  add_way(place, {high.x, low.y}, high, pieces, integral);
  add_way(place, high, {low.x, high.y}, pieces, integral);
  add_way(place, {low.x, high.y}, low, pieces, integral);
  return integral;
}

/// The volume between a point and fans of straight lines from the middles of chords over the ways around a rectangle.
/// The ways are approximated by very short lines.
double fans(const PointAt& place, Vec2 low, Vec2 high, int pieces, const Vec3& from) {
  constexpr int kFine = 2000;
  double volume = 0;
  const std::vector<Vec2> corners{low, {high.x, low.y}, high, {low.x, high.y}, low};
  for (std::size_t c = 0; c + 1 < corners.size(); ++c)
    for (int i = 0; i < pieces; ++i) {
      const auto at = [&](double t) {
        const Vec2 q = corners[c] + (i + t) / pieces * (corners[c + 1] - corners[c]);
        return place(q.x, q.y) - from;
      };
      const Vec3 middle = 0.5 * (at(0) + at(1));
      for (int k = 0; k < kFine; ++k)
        volume -= dot(middle, cross(at(static_cast<double>(k) / kFine), at((k + 1.0) / kFine))) / 6;
    }
  return volume;
}

/// Sums up a rectangle of parameters by small parallelograms.
struct Sums {
  double volume = 0, area = 0;
};
Sums brute_force(const PointAt& place, Vec2 low, Vec2 high, const Vec3& from) {
  constexpr int kSteps = 500;
  const double du = (high.x - low.x) / kSteps, dv = (high.y - low.y) / kSteps;
  Sums sums;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const double u = low.x + (i + 0.5) * du, v = low.y + (j + 0.5) * dv;
      const Vec3 along = (1 / du) * (place(u + du / 2, v) - place(u - du / 2, v));
      const Vec3 up = (1 / dv) * (place(u, v + dv / 2) - place(u, v - dv / 2));
      const Vec3 normal = cross(along, up);
      sums.volume += dot(place(u, v) - from, normal) / 3 * du * dv;
      sums.area += norm(normal) * du * dv;
    }
  return sums;
}

void expect_like_brute_force(const AnalyticSurface& shape, const PointAt& place, Vec2 low, Vec2 high) {
  constexpr int kPieces = 3;
  const SurfaceIntegral integral = over(shape, place, low, high, kPieces);
  const Sums sums = brute_force(place, low, high, integral.centre());
  const double volume = sums.volume + fans(place, low, high, kPieces, integral.centre());
  EXPECT_NEAR(integral.area(), sums.area, 2e-5 * sums.area);
  EXPECT_NEAR(integral.volume(), volume, 2e-5 * std::fabs(sums.area * norm(place(low.x, low.y) - integral.centre())));
}

TEST(surface_integral, a_piece_of_each_kind_has_the_volume_and_area_of_small_parallelograms) {
  const Vec2 low{-0.4, 0.3}, high{1.1, 1.4};
  expect_like_brute_force(
      {SurfaceKind::kCylinder, kCentre, kZ, 2, 0, 0}, [](double u, double v) { return around(2, u, v); }, low, high);
  expect_like_brute_force(
      {SurfaceKind::kCone, kCentre, kZ, 0, 0, 0.5}, [](double u, double v) { return around(v * std::tan(0.5), u, v); },
      low, high);
  expect_like_brute_force(
      {SurfaceKind::kSphere, kCentre, {}, 3, 0, 0},
      [](double u, double v) { return around(3 * std::cos(v), u, 3 * std::sin(v)); }, low, high);
  const AnalyticSurface torus{SurfaceKind::kTorus, kCentre, kZ, 5, 2, 0};
  const PointAt on_torus = [](double u, double v) { return around(5 + 2 * std::cos(v), u, 2 * std::sin(v)); };
  expect_like_brute_force(torus, on_torus, low, high);
  // The inner side of the tube, across the place where angles jump.
  expect_like_brute_force(torus, on_torus, {-0.4, 2.3}, {1.1, 4.4});
}

TEST(surface_integral, whole_solids_have_their_volumes_to_twelve_digits) {
  // The fans at an octant of a ball lie in planes through its centre.
  const SurfaceIntegral octant = over(
      {SurfaceKind::kSphere, kCentre, {}, 3, 0, 0},
      [](double u, double v) { return around(3 * std::cos(v), u, 3 * std::sin(v)); }, {0, 0},
      {std::numbers::pi / 2, std::numbers::pi / 2}, 3);
  EXPECT_NEAR(octant.volume(), 27 * std::numbers::pi / 6, 1e-12 * 27);
  EXPECT_NEAR(octant.area(), 9 * std::numbers::pi / 2, 1e-12 * 9);
  // Half of a cylinder: its plane goes through the centre. At its ends, the fans reach from the arcs to their chords.
  const int pieces = 3;
  const SurfaceIntegral half = over(
      {SurfaceKind::kCylinder, kCentre, kZ, 2, 0, 0}, [](double u, double v) { return around(2, u, v); }, {0, 0},
      {std::numbers::pi, 7}, pieces);
  const double polygon = pieces * 2 * std::sin(std::numbers::pi / pieces);
  EXPECT_NEAR(half.volume(), 7 * 2 * std::numbers::pi - 7 * polygon / 3, 1e-12 * 44);
  EXPECT_NEAR(half.area(), 14 * std::numbers::pi, 1e-12 * 44);
  // A quarter of a ring, as four pieces around the tube, between two planes through the centre.
  double ring = 0, area = 0;
  for (int q = 0; q < 4; ++q) {
    const SurfaceIntegral quarter = over(
        {SurfaceKind::kTorus, kCentre, kZ, 5, 2, 0},
        [](double u, double v) { return around(5 + 2 * std::cos(v), u, 2 * std::sin(v)); },
        {0, q * std::numbers::pi / 2}, {std::numbers::pi / 2, (q + 1) * std::numbers::pi / 2}, 3);
    ring += quarter.volume();
    area += quarter.area();
  }
  EXPECT_NEAR(ring, std::numbers::pi * 4 * 5 * std::numbers::pi / 2, 1e-11 * 100);
  EXPECT_NEAR(area, 2 * std::numbers::pi * 2 * 5 * std::numbers::pi / 2, 1e-11 * 100);
}

TEST(surface_integral, a_piece_on_the_right_counts_negative_and_units_divide) {
  const AnalyticSurface shape{SurfaceKind::kCylinder, kCentre, kZ, 2, 0, 0};
  const PointAt place = [](double u, double v) { return around(2, u, v); };
  const PointAt mirrored = [](double u, double v) { return around(2, -u, v); };
  const SurfaceIntegral left = over(shape, place, {-1, -1}, {1, 1}, 3),
                        right = over(shape, mirrored, {-1, -1}, {1, 1}, 3);
  EXPECT_GT(left.volume(), 0);
  EXPECT_NEAR(right.volume(), -left.volume(), 1e-14);
  EXPECT_NEAR(right.area(), -left.area(), 1e-14);
  const SurfaceIntegral halved = over(shape, place, {-1, -1}, {1, 1}, 3, 0.5);
  EXPECT_DOUBLE_EQ(halved.volume(), 8 * left.volume());
  EXPECT_DOUBLE_EQ(halved.area(), 4 * left.area());
}

}  // namespace
}  // namespace remesh
