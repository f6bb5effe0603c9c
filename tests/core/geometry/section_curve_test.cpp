#include "core/geometry/surfaces/section_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/plain_surfaces.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

AnalyticSurface cylinder(double radius) { return {SurfaceKind::kCylinder, {1, 2, 3}, {0, 0, 1}, radius, 0, 0}; }
AnalyticSurface cone(double half_angle) { return {SurfaceKind::kCone, {1, 2, 3}, {0, 0, 1}, 0, 0, half_angle}; }
AnalyticSurface sphere(double radius) { return {SurfaceKind::kSphere, {1, 2, 3}, {}, radius, 0, 0}; }
AnalyticSurface torus(double radius, double tube) {
  return {SurfaceKind::kTorus, {1, 2, 3}, {0, 0, 1}, radius, tube, 0};
}

/// Returns points of a circle about the direction z or y.
std::vector<Vec3> circle(const Vec3& centre, double radius, bool is_about_z, int count = 12) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double c = radius * std::cos(2 * std::numbers::pi * i / count),
                 s = radius * std::sin(2 * std::numbers::pi * i / count);
    points.push_back(centre + (is_about_z ? Vec3{c, s, 0} : Vec3{c, 0, s}));
  }
  return points;
}

/// Expects that the curve is on the surface and in the plane everywhere, and that it goes through the points.
void expect_on_both(const SectionCurve& curve, const AnalyticSurface& surface, const Plane& plane,
                    const std::vector<Vec3>& points, double first = -std::numbers::pi, double last = std::numbers::pi) {
  const test::PlainSurface plain{surface.kind,
                                 surface.origin,
                                 surface.axis,
                                 surface.radius,
                                 surface.minor_radius,
                                 surface.half_angle * 180 / std::numbers::pi,
                                 {}};
  for (int i = 0; i <= 100; ++i) {
    const Vec3 p = curve.point(first + (last - first) * i / 100);
    EXPECT_LE(plain.distance(p), 1e-13 * (1 + norm(p)));
    EXPECT_LE(std::fabs(dot(p - plane.origin, plane.normal)), 1e-13 * (1 + norm(p)));
  }
  for (const Vec3& p : points) EXPECT_LE(norm(curve.point(curve.angle(p)) - p), 1e-12 * (1 + norm(p)));
  EXPECT_NEAR(curve.angle(points.front()), 0, 1e-15);
}

TEST(section_curve, a_plane_across_the_axis_cuts_a_cylinder_in_a_circle) {
  const Plane plane{{7, -5, 4}, {0, 0, -1}};
  const auto points = circle({1, 2, 4}, 5, true);
  const auto curve = SectionCurve::through(points, cylinder(5), plane, 1e-12);
  ASSERT_TRUE(curve);
  expect_on_both(*curve, cylinder(5), plane, points);
  EXPECT_NEAR(curve->angle(points[3]), std::numbers::pi / 2, 1e-15);
}

TEST(section_curve, oblique_planes_cut_cylinders_and_cones_wherever_rulings_meet_them) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const double half_angle = random.uniform(0.05, 1.2);
    const AnalyticSurface surface = trial % 2 == 0 ? cylinder(random.uniform(0.1, 9)) : cone(half_angle);
    const Vec3 normal = normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.3, 1)});
    const Plane plane{surface.origin + Vec3{0, 0, random.uniform(1, 5)}, normal};
    // Some points of the section, made with formulas of our own.
    std::vector<Vec3> points;
    const double first = random.uniform(-std::numbers::pi, std::numbers::pi), turn = random.uniform(0.2, 2);
    double least = 1;
    for (int i = 0; i <= 10; ++i) {
      const double angle = first + turn * i / 10;
      const Vec3 out{std::cos(angle), std::sin(angle), 0};
      const Vec3 start = surface.kind == SurfaceKind::kCone ? surface.origin : surface.origin + surface.radius * out;
      const Vec3 ruling = surface.kind == SurfaceKind::kCone
                              ? Vec3{0, 0, std::cos(half_angle)} + std::sin(half_angle) * out
                              : Vec3{0, 0, 1};
      const double way = dot(plane.origin - start, normal) / dot(ruling, normal);
      points.push_back(start + way * ruling);
      least = std::min(least, surface.kind == SurfaceKind::kCone && way <= 0 ? 0 : std::fabs(dot(ruling, normal)));
    }
    const auto curve = SectionCurve::through(points, surface, plane, 1e-9);
    if (least < 0.09) {
      EXPECT_FALSE(curve);
    } else if (least > 0.11) {
      ASSERT_TRUE(curve) << trial;
      expect_on_both(*curve, surface, plane, points, 0, curve->angle(points.back()));
    }
  }
}

TEST(section_curve, every_plane_cuts_a_sphere_in_a_circle) {
  for (const double height : {0.0, 1.0, -2.7}) {
    const Plane plane{{9, 9, 3 + height}, {0, 0, 1}};
    const auto points = circle({1, 2, 3 + height}, std::sqrt(9 - height * height), true);
    const auto curve = SectionCurve::through(points, sphere(3), plane, 1e-12);
    ASSERT_TRUE(curve) << height;
    expect_on_both(*curve, sphere(3), plane, points);
  }
}

TEST(section_curve, planes_across_and_through_the_axis_cut_a_torus_in_circles) {
  for (const double height : {0.0, 0.8, -1.5})
    for (const int sign : {-1, 1}) {
      const Plane plane{{0, 0, 3 + height}, {0, 0, 1}};
      const auto points = circle({1, 2, 3 + height}, 6 + sign * std::sqrt(4 - height * height), true);
      const auto curve = SectionCurve::through(points, torus(6, 2), plane, 1e-12);
      ASSERT_TRUE(curve);
      expect_on_both(*curve, torus(6, 2), plane, points);
    }
  for (const int sign : {-1, 1}) {
    const Plane plane{{1, 2, 3}, {0, 1, 0}};
    const auto points = circle({1.0 + sign * 6, 2, 3}, 2, false);
    const auto curve = SectionCurve::through(points, torus(6, 2), plane, 1e-12);
    ASSERT_TRUE(curve);
    expect_on_both(*curve, torus(6, 2), plane, points);
  }
}

TEST(section_curve, where_a_plane_touches_a_torus_the_points_tell_the_radius) {
  // The plane is a little too high, so that it does not even meet the torus.
  const Plane plane{{0, 0, 5 + 1e-9}, {0, 0, 1}};
  const auto points = circle({1, 2, 5}, 6, true);
  const auto curve = SectionCurve::through(points, torus(6, 2), plane, 1e-8);
  ASSERT_TRUE(curve);
  for (const Vec3& p : points) EXPECT_LE(norm(curve->point(curve->angle(p)) - p), 1e-8);
}

TEST(section_curve, a_small_patch_whose_plane_misses_the_axis_of_a_torus_has_the_circle_of_its_points) {
  // The plane of a small patch, 25 from the axis, is turned by 1e-5, so that it misses the axis by 2.5e-4.
  const Vec3 centre{26, 2, 3};
  std::vector<Vec3> points;
  for (int i = 0; i <= 8; ++i) points.push_back(centre + Vec3{3 * std::cos(0.05 * i), 0, 3 * std::sin(0.05 * i)});
  const Plane plane{points[4], normalized(Vec3{1e-5, 1, 0})};
  for (const Vec3& p : points) ASSERT_LE(std::fabs(dot(p - plane.origin, plane.normal)), 3e-6);
  const auto curve = SectionCurve::through(points, torus(25, 3), plane, 1e-5);
  ASSERT_TRUE(curve);
  for (const Vec3& p : points) EXPECT_LE(norm(curve->point(curve->angle(p)) - p), 1e-12 * norm(p));
}

TEST(section_curve, there_is_none_where_points_are_off_the_surface_or_a_ruling_runs_along_the_plane) {
  const Plane across{{0, 0, 4}, {0, 0, 1}};
  auto points = circle({1, 2, 4}, 5, true);
  points[4] = points[4] + Vec3{0, 1e-3, 0};
  EXPECT_FALSE(SectionCurve::through(points, cylinder(5), across, 1e-4));
  EXPECT_FALSE(SectionCurve::through(circle({1, 2, 4.1}, 5, true), cylinder(5), across, 1e-4));
  const std::vector<Vec3> ruling{{6, 2, 0}, {6, 2, 9}};
  EXPECT_FALSE(SectionCurve::through(ruling, cylinder(5), {{6, 2, 0}, {1, 0, 0}}, 1e-4));
  EXPECT_FALSE(SectionCurve::through(ruling, cylinder(5), {{6, 2, 0}, {0, 1, 0}}, 1e-4));
}

TEST(section_curve, a_cone_that_is_almost_a_cylinder_loses_no_digits) {
  // The apex is ten million radii away.
  const AnalyticSurface far{SurfaceKind::kCone, {0, 0, -1e7}, {0, 0, 1}, 0, 0, std::atan(1e-7)};
  const Plane plane{{0, 0, 2}, {0, 0, 1}};
  const auto points = circle({0, 0, 2}, 1 + 2e-7, true);
  const auto curve = SectionCurve::through(points, far, plane, 1e-8);
  ASSERT_TRUE(curve);
  for (int i = 0; i < 12; ++i) {
    const Vec3 p = curve->point(2 * std::numbers::pi * i / 12);
    EXPECT_NEAR(std::hypot(p.x, p.y), 1 + 2e-7, 1e-14);
    EXPECT_NEAR(p.z, 2, 1e-14);
  }
}

}  // namespace
}  // namespace remesh
