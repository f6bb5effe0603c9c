#include "tests/support/polygons.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/cgal_plane.h"

namespace remesh::polygons {
namespace {

::testing::AssertionResult is_valid(const Polygon& polygon) {
  const std::string fault = cgal_fault_of(polygon);
  return fault.empty() ? ::testing::AssertionSuccess() : ::testing::AssertionFailure() << fault;
}

TEST(polygons, every_generator_gives_simple_loops_with_disjoint_holes_inside) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const int n = static_cast<int>(seed);
    EXPECT_TRUE(is_valid(star_with_holes(seed, 3 + n, n / 4)));
    EXPECT_TRUE(is_valid(grown(seed, 5 * n, 4 + n)));
    EXPECT_TRUE(is_valid(rectilinear_with_holes(seed, n)));
    EXPECT_TRUE(is_valid(comb(n, 7)));
    EXPECT_TRUE(is_valid(spiral(n)));
  }
  EXPECT_TRUE(is_valid(l_shape()));
  EXPECT_TRUE(is_valid(sieve(5)));
}

TEST(polygons, areas_are_those_of_the_drawing) {
  EXPECT_EQ(area(l_shape()), 3);
  EXPECT_EQ(area(comb(4, 7)), 7 + 4 * 7);
  EXPECT_EQ(area(spiral(3)), 2 + 2 + 4);
  EXPECT_NEAR(area(sieve(3)), 0.75, 1e-4);
}

TEST(polygons, the_patch_input_keeps_the_directed_edges) {
  const Polygon polygon = star_with_holes(7, 20, 3);
  ASSERT_FALSE(polygon.holes.empty());
  const PatchInput input = patch_input(polygon);
  EXPECT_EQ(input.points.size(), input.edges.size());
  double twice_area = 0;
  for (const Segment& edge : input.edges) twice_area += cross(input.points[edge[0]], input.points[edge[1]]);
  EXPECT_NEAR(twice_area / 2, area(polygon), 1e-12);
}

TEST(polygons, the_integer_circle_has_all_its_points) {
  const std::vector<Vec2> points = cocircular();
  EXPECT_EQ(points.size(), 324u);  // 4 (2+1)^4: the number of ways to write 32045^2 as a sum of two squares
  for (const Vec2 p : points) EXPECT_EQ(dot(p, p), 32045.0 * 32045.0);
}

TEST(polygons, a_placement_is_a_similarity) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Placement place = random_placement(seed, 8);
    EXPECT_NEAR(norm(place.x_axis), 8, 1e-14);
    EXPECT_NEAR(norm(place.y_axis), 8, 1e-14);
    EXPECT_NEAR(dot(place.x_axis, place.y_axis), 0, 1e-14);
  }
}

}  // namespace
}  // namespace remesh::polygons
