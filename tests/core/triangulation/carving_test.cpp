#include "core/triangulation/carving.h"

#include <gtest/gtest.h>

#include "core/triangulation/patch_triangulation.h"
#include "tests/support/polygons.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

struct Carved {
  TriangulationOutcome outcome = TriangulationOutcome::kDone;
  std::vector<Vec2> points;
  Triangulation2d mesh;

  double area() const { return area_of(points, mesh); }
};

/// Carves a region out of loops of corners. The inside is on the left of each loop.
Carved carved(const std::vector<polygons::Loop>& loops, const std::vector<Vec2>& more_points = {}) {
  Carved result;
  result.points = more_points;
  for (const auto& loop : loops) result.points.insert(result.points.end(), loop.begin(), loop.end());
  result.points = polygons::sorted_unique(result.points);
  const auto index = [&](Vec2 p) {
    return static_cast<std::uint32_t>(std::lower_bound(result.points.begin(), result.points.end(), p) -
                                      result.points.begin());
  };
  std::vector<Segment> edges;
  for (const auto& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) edges.push_back({index(loop[i]), index(loop[(i + 1) % loop.size()])});
  RunControl control;
  result.mesh = triangulate_points(result.points, control);
  EXPECT_EQ(constraint_recovery(result.points, edges, result.mesh, control), TriangulationOutcome::kDone);
  const auto before = triangles_of(result.mesh);
  result.outcome = carving(edges, result.mesh, control);
  expect_valid(result.points, result.mesh);
  if (result.outcome != TriangulationOutcome::kDone) {
    EXPECT_EQ(triangles_of(result.mesh), before) << "nothing is removed";
  }
  return result;
}

polygons::Loop square(double low, double high) { return {{low, low}, {high, low}, {high, high}, {low, high}}; }
polygons::Loop reversed(polygons::Loop loop) { return {loop.rbegin(), loop.rend()}; }

TEST(carving, what_lies_outside_a_concave_loop_goes) {
  const Carved result = carved({{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}});
  EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_EQ(result.mesh.triangle_count(), 4u);
  EXPECT_DOUBLE_EQ(result.area(), 3);
}

TEST(carving, holes_go_and_islands_in_them_stay) {
  const Carved result = carved({square(0, 10), reversed(square(1, 9)), square(3, 7), reversed(square(4, 6))});
  EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_DOUBLE_EQ(result.area(), 100 - 64 + 16 - 4);
}

TEST(carving, loops_that_touch_in_a_vertex_stay_apart) {
  // A hole with a corner on the outer corner, and two holes that share a corner.
  const Carved corner = carved({square(0, 8), {{0, 0}, {1, 3}, {3, 1}}});
  EXPECT_EQ(corner.outcome, TriangulationOutcome::kDone);
  EXPECT_DOUBLE_EQ(corner.area(), 64 - 4);
  const Carved pair = carved({square(0, 8), reversed(square(2, 4)), reversed(square(4, 6))});
  EXPECT_EQ(pair.outcome, TriangulationOutcome::kDone);
  EXPECT_DOUBLE_EQ(pair.area(), 64 - 8);
}

TEST(carving, a_slit_has_the_inside_on_both_sides) {
  const Carved result = carved({square(0, 4), {{1, 2}, {3, 2}}});
  EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_DOUBLE_EQ(result.area(), 16);
  EXPECT_EQ(constrained_edges_of(result.mesh).size(), 5u);
}

TEST(carving, points_inside_stay_corners_and_points_outside_do_not) {
  const Carved result = carved({square(0, 4)}, {{2, 1}, {7, 7}});
  EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_DOUBLE_EQ(result.area(), 16);
  EXPECT_EQ(result.mesh.triangle_count(), 4u);
}

TEST(carving, a_loop_that_runs_clockwise_is_inconsistent_or_leaves_nothing) {
  EXPECT_EQ(carved({reversed({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})}).outcome,
            TriangulationOutcome::kInconsistentLoops);
  // A convex loop has no triangles outside, at which the wrong direction could be noticed.
  const Carved convex = carved({reversed(square(0, 4))});
  EXPECT_EQ(convex.outcome, TriangulationOutcome::kDone);
  EXPECT_EQ(convex.mesh.triangle_count(), 0u);
}

TEST(carving, a_hole_that_runs_the_wrong_way_is_inconsistent) {
  EXPECT_EQ(carved({square(0, 9), square(3, 6)}).outcome, TriangulationOutcome::kInconsistentLoops);
}

TEST(carving, a_hole_outside_is_inconsistent) {
  EXPECT_EQ(carved({square(0, 4), reversed(square(6, 8))}).outcome, TriangulationOutcome::kInconsistentLoops);
}

TEST(carving, random_polygons_with_holes_keep_their_area) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const polygons::Polygon polygon = polygons::rectilinear_with_holes(seed, 12);
    std::vector<polygons::Loop> loops = polygon.holes;
    loops.push_back(polygon.outer);
    const Carved result = carved(loops);
    EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
    EXPECT_DOUBLE_EQ(result.area(), polygons::area(polygon)) << seed;
  }
}

}  // namespace
}  // namespace remesh
