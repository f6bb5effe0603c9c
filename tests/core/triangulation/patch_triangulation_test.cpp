#include "core/triangulation/patch_triangulation.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

PatchTriangulation triangulated(const polygons::PatchInput& input) {
  RunControl control;
  return triangulate_patch(input.points, input.edges, control);
}

/// Expects that the triangulation is valid and Delaunay, and that it has the area of the polygon and its edges as the
/// border. By Euler's formula it has n + 2 holes - 2 triangles.
void expect_holds(const polygons::Polygon& polygon) {
  const polygons::PatchInput input = polygons::patch_input(polygon);
  const PatchTriangulation result = triangulated(input);
  ASSERT_EQ(result.outcome, TriangulationOutcome::kDone);
  expect_valid(input.points, result.mesh);
  expect_locally_delaunay(input.points, result.mesh);
  EXPECT_EQ(result.mesh.triangle_count(), input.points.size() + 2 * polygon.holes.size() - 2);
  EXPECT_NEAR(area_of(input.points, result.mesh) / polygons::area(polygon), 1, 1e-12);
  std::set<Segment> border;
  for (const auto& [a, b] : input.edges) border.insert({std::min(a, b), std::max(a, b)});
  EXPECT_EQ(constrained_edges_of(result.mesh), border);
}

TEST(patch_triangulation, small_and_large_polygons_are_triangulated) {
  expect_holds(polygons::l_shape());
  for (const int size : {3, 30, 400}) {
    SCOPED_TRACE(size);
    expect_holds(polygons::comb(size, 4));
    expect_holds(polygons::spiral(size));
  }
  for (const int n : {1, 2, 8, 14}) expect_holds(polygons::sieve(n));
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    expect_holds(polygons::star_with_holes(seed, 4 + 20 * static_cast<int>(seed), static_cast<int>(seed % 5)));
    expect_holds(polygons::grown(seed, 60, 20));
    expect_holds(polygons::rectilinear_with_holes(seed, 20));
  }
}

TEST(patch_triangulation, one_triangle_is_itself) {
  const polygons::PatchInput input = polygons::patch_input({{{0, 0}, {1, 0}, {0, 1}}, {}});
  const PatchTriangulation result = triangulated(input);
  ASSERT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_EQ(triangles_of(result.mesh), (std::vector<Corners>{{0, 2, 1}}));
  EXPECT_EQ(constrained_edges_of(result.mesh).size(), 3u);
}

TEST(patch_triangulation, the_order_of_the_edges_does_not_matter) {
  Random random(1);
  for (const auto& polygon :
       {polygons::sieve(4), polygons::rectilinear_with_holes(3, 20), polygons::star_with_holes(5, 300, 3)}) {
    polygons::PatchInput input = polygons::patch_input(polygon);
    const auto expected = triangles_of(triangulated(input).mesh);
    for (int round = 0; round < 4; ++round) {
      for (std::size_t i = input.edges.size(); i > 1; --i)
        std::swap(input.edges[i - 1], input.edges[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
      EXPECT_EQ(triangles_of(triangulated(input).mesh), expected);
    }
  }
}

TEST(patch_triangulation, points_on_one_line_are_degenerate) {
  RunControl control;
  const std::vector<Vec2> points = polygons::grid(4, 1);
  const std::vector<Segment> edges = {{0, 1}, {1, 2}, {2, 3}, {3, 0}};
  EXPECT_EQ(triangulate_patch(points, edges, control).outcome, TriangulationOutcome::kDegenerate);
  const std::vector<Vec2> three = polygons::grid(3, 1);
  EXPECT_EQ(triangulate_patch(three, std::vector<Segment>{{0, 1}, {1, 2}, {2, 0}}, control).outcome,
            TriangulationOutcome::kDegenerate);
}

TEST(patch_triangulation, a_triangle_turned_over_is_inconsistent) {
  RunControl control;
  const std::vector<Vec2> points = {{0, 0}, {0, 1}, {1, 0}};
  EXPECT_EQ(triangulate_patch(points, std::vector<Segment>{{0, 1}, {1, 2}, {2, 0}}, control).outcome,
            TriangulationOutcome::kInconsistentLoops);
}

TEST(patch_triangulation, a_loop_that_crosses_itself_is_told) {
  RunControl control;
  const std::vector<Vec2> points = polygons::grid(2, 2);
  const PatchTriangulation result =
      triangulate_patch(points, std::vector<Segment>{{0, 3}, {3, 1}, {1, 2}, {2, 0}}, control);
  EXPECT_EQ(result.outcome, TriangulationOutcome::kCrossingConstraints);
  EXPECT_EQ(result.mesh.triangle_count(), 0u);
}

TEST(triangulate_points, few_and_many_points_are_delaunay) {
  RunControl control;
  for (const int n : {3, 50, 255, 256, 257, 1000}) {
    const auto points = polygons::scattered(9, n);
    const Triangulation2d mesh = triangulate_points(points, control);
    expect_valid(points, mesh);
    expect_locally_delaunay(points, mesh);
    EXPECT_EQ(mesh.triangle_count(), 2 * points.size() - 2 - hull_size(points));
  }
}

}  // namespace
}  // namespace remesh
