#include "tests/support/polygons.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace remesh::polygons {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalPolygon = CGAL::Polygon_2<Kernel>;

CgalPolygon to_cgal(const Loop& loop) {
  CgalPolygon polygon;
  for (const Vec2 p : loop) polygon.push_back({p.x, p.y});
  return polygon;
}

/// Whether the loops are simple, turn the right way, and are pairwise without a common point.
::testing::AssertionResult is_valid(const Polygon& polygon) {
  std::vector<CgalPolygon> loops{to_cgal(polygon.outer)};
  for (const Loop& hole : polygon.holes) loops.push_back(to_cgal(hole));
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (!loops[i].is_simple()) return ::testing::AssertionFailure() << "loop " << i << " is not simple";
    if (loops[i].is_clockwise_oriented() != (i > 0)) return ::testing::AssertionFailure() << "loop " << i << " turns";
    if (i > 0 && loops[0].bounded_side(loops[i][0]) != CGAL::ON_BOUNDED_SIDE)
      return ::testing::AssertionFailure() << "hole " << i << " is outside";
    for (std::size_t j = 0; j < i; ++j) {
      if (j > 0 && loops[j].bounded_side(loops[i][0]) != CGAL::ON_UNBOUNDED_SIDE)
        return ::testing::AssertionFailure() << "hole " << i << " is in hole " << j;
      for (auto a = loops[i].edges_begin(); a != loops[i].edges_end(); ++a)
        for (auto b = loops[j].edges_begin(); b != loops[j].edges_end(); ++b)
          if (CGAL::do_intersect(*a, *b)) return ::testing::AssertionFailure() << "loops " << i << ", " << j << " meet";
    }
  }
  return ::testing::AssertionSuccess();
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
