#include "core/geometry/triangles/distances.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/cgal_space.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// Returns a random place on a coarse grid, so that parallel sides, common planes and contacts come by chance.
Vec3 place(Random& random) {
  return {0.25 * random.integer(-4, 4), 0.25 * random.integer(-4, 4), 0.25 * random.integer(-4, 4)};
}
Corners3 corners(Random& random) {
  while (true) {
    const Corners3 t = {place(random), place(random), place(random)};
    if (norm_squared(cross(t[1] - t[0], t[2] - t[0])) > 0) return t;
  }
}

TEST(distances, the_nearest_place_of_a_triangle_is_on_it_and_as_far_as_the_oracle_says) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const Corners3 t = corners(random);
    const Vec3 p = place(random);
    const Vec3 q = nearest_on_triangle(p, t);
    EXPECT_NEAR(norm(q - p), std::sqrt(cgal_squared_distance(p, t)), 1e-12);
    EXPECT_LE(cgal_squared_distance(q, t), 1e-28);
  }
}

TEST(distances, triangles_without_area_are_segments_and_points) {
  EXPECT_EQ(nearest_on_triangle({1, 1, 0}, {Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{2, 0, 0}}), (Vec3{1, 0, 0}));
  EXPECT_EQ(nearest_on_triangle({1, 1, 0}, {Vec3{3, 0, 0}, Vec3{3, 0, 0}, Vec3{3, 0, 0}}), (Vec3{3, 0, 0}));
  EXPECT_EQ(nearest_on_segment({1, 1, 1}, {2, 2, 2}, {2, 2, 2}), (Vec3{2, 2, 2}));
}

TEST(distances, triangles_that_do_not_cross_are_as_far_apart_as_the_oracle_says) {
  Random random(2);
  int apart = 0;
  for (int i = 0; i < 20000; ++i) {
    const Corners3 s = corners(random), t = corners(random);
    const double expected = cgal_squared_distance(s, t);
    if (!(expected > 0)) continue;
    ++apart;
    EXPECT_NEAR(norm_squared(shortest_way(s, t)), expected, 1e-12);
  }
  EXPECT_GT(apart, 1000);
}

TEST(distances, crossing_edges_are_nearest_between_their_ends) {
  // Two needles across each other, 1/2 apart.
  EXPECT_DOUBLE_EQ(norm_squared(shortest_way({Vec3{-1, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 0, -1}},
                                             {Vec3{0, -1, 0.5}, Vec3{0, 1, 0.5}, Vec3{0, 0, 2}})),
                   0.25);
}

}  // namespace
}  // namespace remesh
