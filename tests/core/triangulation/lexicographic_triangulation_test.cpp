#include "core/triangulation/lexicographic_triangulation.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

Triangulation2d sweep(const std::vector<Vec2>& points) {
  RunControl control;
  return lexicographic_triangulation(points, control);
}

/// Returns twice the area of the convex hull of integer or dyadic points. It is exact if the points are small.
double hull_area(const std::vector<Vec2>& sorted) {
  std::vector<Vec2> ring;
  for (const int side : {1, -1}) {
    std::vector<Vec2> chain;
    for (std::size_t i = 0; i < sorted.size(); ++i) {
      const Vec2 p = sorted[side > 0 ? i : sorted.size() - 1 - i];
      while (chain.size() >= 2 && cross(chain.back() - chain[chain.size() - 2], p - chain.back()) <= 0)
        chain.pop_back();
      chain.push_back(p);
    }
    ring.insert(ring.end(), chain.begin(), chain.end() - 1);
  }
  return polygons::area(ring);
}

void expect_holds(const std::vector<Vec2>& points, const Triangulation2d& mesh) {
  expect_valid(points, mesh);
  EXPECT_EQ(mesh.triangle_count(), 2 * points.size() - 2 - hull_size(points));
  std::set<std::uint32_t> used;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) used.insert(mesh.from(h));
  EXPECT_EQ(used.size(), points.size()) << "every point is a corner";
  // Valid, as many triangles as the hull's triangulation has, and its area: no gap and no overlap.
  EXPECT_NEAR(area_of(points, mesh) / hull_area(points), 1, 1e-12);
}

TEST(lexicographic_triangulation, a_triangle_is_itself) {
  const std::vector<Vec2> points = {{0, 0}, {0, 1}, {1, 0}};
  EXPECT_EQ(triangles_of(sweep(points)), (std::vector<Corners>{{0, 2, 1}}));
}

TEST(lexicographic_triangulation, a_collinear_run_at_the_start_waits_for_the_first_point_beside_it) {
  // The point is on the left of the run or on its right, and the line ends there or goes on afterwards.
  for (const Vec2 beside : {Vec2{10, 3}, Vec2{10, -3}, Vec2{2.5, 5}, Vec2{2.5, -5}}) {
    const std::vector<Vec2> points = polygons::sorted_unique({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, beside});
    const Triangulation2d mesh = sweep(points);
    EXPECT_EQ(mesh.triangle_count(), 4u);
    expect_holds(points, mesh);
  }
  const std::vector<Vec2> vertical = polygons::sorted_unique({{0, 0}, {0, 1}, {0, 2}, {0, 3}, {1, 7}, {2, -9}});
  expect_holds(vertical, sweep(vertical));
}

TEST(lexicographic_triangulation, points_on_one_line_have_no_triangle) {
  EXPECT_EQ(sweep({}).triangle_count(), 0u);
  EXPECT_EQ(sweep({{0, 0}}).triangle_count(), 0u);
  EXPECT_EQ(sweep({{0, 0}, {1, 1}}).triangle_count(), 0u);
  EXPECT_EQ(sweep(polygons::on_lines(1, 1, 50, 3, 7)).triangle_count(), 0u);
  EXPECT_EQ(sweep(polygons::grid(1, 50)).triangle_count(), 0u);
}

TEST(lexicographic_triangulation, every_subset_of_a_small_grid_is_triangulated) {
  const std::vector<Vec2> all = polygons::grid(4, 3);
  for (unsigned subset = 0; subset < 1u << all.size(); ++subset) {
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (subset >> i & 1u) points.push_back(all[i]);
    const Triangulation2d mesh = sweep(points);
    bool is_flat = true;
    for (const Vec2 p : points) is_flat = is_flat && cross(points.back() - points.front(), p - points.front()) == 0;
    if (is_flat)
      ASSERT_EQ(mesh.triangle_count(), 0u) << subset;
    else
      expect_holds(points, mesh);
    ASSERT_FALSE(HasFailure()) << subset;
  }
}

TEST(lexicographic_triangulation, families_of_hard_points_are_triangulated) {
  for (const auto& points :
       {polygons::scattered(1, 3000), polygons::grid(40, 30), polygons::grid(60, 60, 0.3),
        polygons::turned_grid(30, 30, 0.3), polygons::cocircular(), polygons::parabola(300),
        polygons::on_lines(1, 4, 100, 3, 7), polygons::on_lines(2, 3, 100, 0, 1), polygons::clusters(1, 8, 60)})
    expect_holds(points, sweep(points));
}

STAGE(lexicographic_triangulation, test::kStop) {
  lexicographic_triangulation(polygons::scattered(1, 10000), trial.control);
}

}  // namespace
}  // namespace remesh
