#include "core/geometry/planes/plane_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random.h"

namespace remesh {
namespace {

TEST(fit_plane, it_finds_the_plane_that_points_lie_in) {
  Random random(7);
  for (int round = 0; round < 100; ++round) {
    const Vec3 normal = normalized({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1) + 2});
    const Vec3 x = normalized(cross(normal, {1, 0, 0})), y = cross(normal, x);
    PointMoments moments;
    for (int i = 0; i < 20; ++i) moments.add(0.1 * normal + random.uniform(-1, 1) * x + random.uniform(-1, 1) * y);
    const PlaneFit fit = fit_plane(moments);
    EXPECT_NEAR(std::fabs(dot(fit.normal, normal)), 1, 1e-14);
    EXPECT_NEAR(dot(moments.mean(), normal), 0.1, 1e-14);
    EXPECT_LT(fit.rms, 1e-7);
  }
}

TEST(fit_plane, the_rest_is_the_distance_of_the_points) {
  PointMoments moments;
  for (const double x : {-1, 1})
    for (const double y : {-1, 1})
      for (const double z : {-0.25, 0.25}) moments.add({x, y, z});
  EXPECT_NEAR(fit_plane(moments).rms, 0.25, 1e-15);
  EXPECT_NEAR(std::fabs(fit_plane(moments).normal.z), 1, 1e-15);
}

TEST(fit_plane, moments_of_two_sets_add_up) {
  PointMoments a, b, both;
  a.add({1, 2, 3});
  b.add({4, 5, 7});
  both.add({1, 2, 3});
  both.add({4, 5, 7});
  a.merge(b);
  EXPECT_EQ(a.count, both.count);
  EXPECT_EQ(a.sum, both.sum);
  EXPECT_EQ(a.products, both.products);
}

}  // namespace
}  // namespace remesh
