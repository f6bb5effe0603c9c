#include "core/geometry/surfaces/analytic_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/surfaces/surface_fit.h"

#include "tests/support/invariance.h"

namespace remesh {
namespace {

const std::vector<AnalyticSurface>& surfaces() {
  static const Vec3 axis = normalized({1, 2, 3});
  static const std::vector<AnalyticSurface> all{{SurfaceKind::kPlane, {1, 0, 2}, axis, 0, 0, 0},
                                                {SurfaceKind::kCylinder, {1, 0, 2}, axis, 1.5, 0, 0},
                                                {SurfaceKind::kCone, {1, 0, 2}, axis, 0, 0, 0.6},
                                                {SurfaceKind::kSphere, {1, 0, 2}, {}, 1.5, 0, 0},
                                                {SurfaceKind::kTorus, {1, 0, 2}, axis, 3, 1.25, 0}};
  return all;
}

std::vector<Vec3> random_points(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-4, 4);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back({place(random), place(random), place(random)});
  return points;
}

/// Returns points of a surface. Each is where a random point is moved along the normal.
std::vector<Vec3> points_of(const AnalyticSurface& surface) {
  std::vector<Vec3> points;
  for (Vec3 p : random_points(200, 7)) {
    // Half of a cone is no part of it.
    if (surface.kind == SurfaceKind::kCone && dot(p - surface.origin, surface.axis) < 0.5) continue;
    points.push_back(p - surface.distance(p) * surface.normal(p));
  }
  return points;
}

TEST(analytic_surface, the_normal_is_the_slope_of_the_distance) {
  for (const AnalyticSurface& surface : surfaces())
    for (const Vec3& p : random_points(50, 3)) {
      constexpr double kStep = 1e-6;
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 before = p, after = p;
        before[axis] -= kStep;
        after[axis] += kStep;
        const double slope = (surface.distance(after) - surface.distance(before)) / (2 * kStep);
        EXPECT_NEAR(slope, surface.normal(p)[axis], 1e-5) << kind_name(surface.kind);
      }
    }
}

TEST(analytic_surface, a_point_moved_by_its_distance_along_the_normal_is_on_the_surface) {
  for (const AnalyticSurface& surface : surfaces())
    for (const Vec3& p : points_of(surface)) EXPECT_NEAR(surface.distance(p), 0, 1e-12) << kind_name(surface.kind);
}

TEST(surface_fit, a_fit_finds_the_surface_again_from_a_start_beside_it) {
  for (const AnalyticSurface& surface : surfaces()) {
    if (surface.kind == SurfaceKind::kPlane) continue;
    SCOPED_TRACE(kind_name(surface.kind));
    AnalyticSurface start = surface;
    start.origin += Vec3{0.03, -0.02, 0.04};
    if (surface.kind != SurfaceKind::kSphere) start.axis = normalized(start.axis + Vec3{0.02, 0.01, -0.03});
    start.radius *= 1.02;
    start.minor_radius *= 0.98;
    start.half_angle *= 1.02;
    const auto fitted = fit_from(start, points_of(surface));
    ASSERT_TRUE(fitted);
    for (const Vec3& p : points_of(surface)) EXPECT_NEAR(fitted->distance(p), 0, 1e-9);
    EXPECT_NEAR(fitted->radius, surface.radius, 1e-9);
    EXPECT_NEAR(fitted->minor_radius, surface.minor_radius, 1e-9);
    EXPECT_NEAR(fitted->half_angle, surface.half_angle, 1e-9);
  }
}

STAGE(surface_fit, test::kStop) {
  AnalyticSurface start = surfaces()[1];
  start.radius = 2;
  (void)fit_from(start, points_of(surfaces()[1]), {.control = &trial.control});
}

}  // namespace
}  // namespace remesh
