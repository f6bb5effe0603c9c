#include "core/triangulation/constraint_recovery.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/triangulation/delaunay_flips.h"
#include "core/triangulation/lexicographic_triangulation.h"
#include "tests/support/cgal_plane.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

Triangulation2d delaunay(const std::vector<Vec2>& points) {
  RunControl control;
  Triangulation2d mesh = lexicographic_triangulation(points, control);
  delaunay_flips(points, mesh, control);
  return mesh;
}

struct Recovered {
  TriangulationOutcome outcome;
  Triangulation2d mesh;
};

Recovered recovered(const std::vector<Vec2>& points, const std::vector<Segment>& segments) {
  RunControl control;
  Recovered result{TriangulationOutcome::kDone, delaunay(points)};
  result.outcome = constraint_recovery(points, segments, result.mesh, control);
  return result;
}

/// Returns random segments that neither cross each other nor pass through a point. Of the `attempts` segments, those
/// that would do so are left out.
std::vector<Segment> random_segments(const std::vector<Vec2>& points, int attempts, std::uint64_t seed) {
  Random random(seed);
  std::vector<Segment> segments;
  const int n = static_cast<int>(points.size());
  for (int i = 0; i < attempts; ++i) {
    const Segment s{static_cast<std::uint32_t>(random.below(n)), static_cast<std::uint32_t>(random.below(n))};
    if (s[0] == s[1] || has_point_inside(points, s)) continue;
    if (std::none_of(segments.begin(), segments.end(),
                     [&](const Segment& t) { return segments_conflict(points, s, t); }))
      segments.push_back(s);
  }
  return segments;
}

void expect_holds(const std::vector<Vec2>& points, const std::vector<Segment>& segments, const Triangulation2d& mesh) {
  expect_valid(points, mesh);
  expect_locally_delaunay(points, mesh);
  EXPECT_EQ(mesh.triangle_count(), 2 * points.size() - 2 - hull_size(points));
  std::set<Segment> wanted;
  for (const auto& [a, b] : segments) wanted.insert({std::min(a, b), std::max(a, b)});
  EXPECT_EQ(constrained_edges_of(mesh), wanted);
}

TEST(constraint_recovery, an_edge_that_is_there_is_only_marked) {
  const std::vector<Vec2> points = polygons::grid(3, 3);
  const auto before = triangles_of(delaunay(points));
  const Recovered result = recovered(points, {{0, 1}, {1, 0}, {4, 1}});
  EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_EQ(triangles_of(result.mesh), before);
  expect_holds(points, {{0, 1}, {1, 4}}, result.mesh);
}

TEST(constraint_recovery, a_diagonal_is_forced_in) {
  const std::vector<Vec2> points = {{0, 0}, {4, -1}, {4, 1}, {8, 0}};
  const Recovered result = recovered(points, {{3, 0}});
  EXPECT_EQ(result.outcome, TriangulationOutcome::kDone);
  EXPECT_EQ(triangles_of(result.mesh), (std::vector<Corners>{{0, 1, 3}, {0, 3, 2}}));
}

TEST(constraint_recovery, an_edge_that_hangs_in_the_cavity_is_kept) {
  // The segment from far left to far right passes under (5, 1), which hangs on (5, 4): both triangles at that edge are
  // crossed.
  const std::vector<Vec2> points = {{-20, 0}, {3, -3}, {5, 1}, {5, 4}, {7, -3}, {30, 0}};
  const auto before = edges_of(delaunay(points));
  ASSERT_TRUE(before.count({2, 3}));
  ASSERT_TRUE(before.count({1, 3}) && before.count({3, 4})) << "the triangles beside it are crossed";
  const std::vector<Segment> segments = {{0, 5}};
  const Recovered result = recovered(points, segments);
  ASSERT_EQ(result.outcome, TriangulationOutcome::kDone);
  expect_holds(points, segments, result.mesh);
  EXPECT_EQ(triangles_of(result.mesh), cgal_cdt(points, segments));
}

TEST(constraint_recovery, a_segment_across_many_triangles_is_forced_in) {
  std::vector<Vec2> points = polygons::scattered(5, 400);
  for (Vec2& p : points) p.y = p.y == 0 ? 0.5 : p.y;
  points.push_back({-2, 0});
  points.push_back({2, 0});
  points = polygons::sorted_unique(points);
  const std::vector<Segment> segments = {{static_cast<std::uint32_t>(points.size() - 1), 0}};
  const Recovered result = recovered(points, segments);
  ASSERT_EQ(result.outcome, TriangulationOutcome::kDone);
  expect_holds(points, segments, result.mesh);
  EXPECT_EQ(triangles_of(result.mesh), cgal_cdt(points, segments));
}

TEST(constraint_recovery, random_segments_give_the_triangles_of_the_oracle) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    const auto points = polygons::scattered(seed, 5 + static_cast<int>(seed) * 2);
    const auto segments = random_segments(points, 200, seed);
    const Recovered result = recovered(points, segments);
    ASSERT_EQ(result.outcome, TriangulationOutcome::kDone);
    expect_holds(points, segments, result.mesh);
    EXPECT_EQ(triangles_of(result.mesh), cgal_cdt(points, segments));
  }
}

TEST(constraint_recovery, the_order_and_direction_of_the_segments_do_not_matter) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed)
    for (const auto& points : {polygons::scattered(seed, 60), polygons::grid(8, 8), polygons::turned_grid(8, 8, 0.3),
                               polygons::nearly_cocircular(60)}) {
      auto segments = random_segments(points, 300, seed);
      const Recovered first = recovered(points, segments);
      ASSERT_EQ(first.outcome, TriangulationOutcome::kDone);
      expect_holds(points, segments, first.mesh);
      Random random(seed);
      for (int round = 0; round < 4; ++round) {
        for (std::size_t i = segments.size(); i > 1; --i)
          std::swap(segments[i - 1], segments[static_cast<std::size_t>(random.below(static_cast<int>(i)))]);
        for (Segment& s : segments)
          if (random.chance(0.5)) std::swap(s[0], s[1]);
        ASSERT_EQ(triangles_of(recovered(points, segments).mesh), triangles_of(first.mesh));
      }
    }
}

TEST(constraint_recovery, segments_that_cross_are_told_and_leave_a_valid_triangulation) {
  const std::vector<Vec2> points = polygons::sorted_unique({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {1, 2}, {3, 1}});
  const Recovered result = recovered(points, {{0, 5}, {1, 4}});  // the diagonals of the square
  EXPECT_EQ(result.outcome, TriangulationOutcome::kCrossingConstraints);
  expect_valid(points, result.mesh);
  EXPECT_EQ(result.mesh.triangle_count(), 2 * points.size() - 2 - hull_size(points));
}

TEST(constraint_recovery, a_point_inside_a_segment_is_told) {
  const std::vector<Vec2> points = polygons::grid(3, 3);
  for (const Segment& s : {Segment{0, 2}, Segment{0, 8}, Segment{8, 0}, Segment{3, 5}, Segment{1, 7}}) {
    const Recovered result = recovered(points, {s});
    EXPECT_EQ(result.outcome, TriangulationOutcome::kCrossingConstraints) << s[0] << '-' << s[1];
    expect_valid(points, result.mesh);
  }
}

STAGE(constraint_recovery, test::kStop) {
  const auto points = polygons::scattered(1, 2000);
  Triangulation2d mesh = delaunay(points);
  const std::vector<Segment> segments(3000, Segment{0, mesh.to(mesh.half_edge_count() - 1)});
  constraint_recovery(points, segments, mesh, trial.control);
}

}  // namespace
}  // namespace remesh
