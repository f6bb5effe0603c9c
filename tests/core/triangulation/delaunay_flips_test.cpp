#include "core/triangulation/delaunay_flips.h"

#include <gtest/gtest.h>

#include "core/geometry/exact/predicates.h"
#include "core/triangulation/lexicographic_triangulation.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

Triangulation2d swept(const std::vector<Vec2>& points) {
  RunControl control;
  return lexicographic_triangulation(points, control);
}

void flip_all(const std::vector<Vec2>& points, Triangulation2d& mesh) {
  RunControl control;
  delaunay_flips(points, mesh, control);
}

/// Turns a triangulation into another one of the same points by random flips of convex quadrilaterals.
void shuffle(const std::vector<Vec2>& points, Triangulation2d& mesh, std::uint64_t seed) {
  Random random(seed);
  for (std::uint32_t i = 0; i < 4 * mesh.half_edge_count(); ++i) {
    const auto h = static_cast<std::uint32_t>(random.below(static_cast<int>(mesh.half_edge_count())));
    const std::uint32_t g = mesh.twin(h);
    if (g == Triangulation2d::kNoHalfEdge || mesh.is_constrained(h)) continue;
    const Vec2 a = points[mesh.from(h)], b = points[mesh.to(h)], c = points[mesh.apex(h)], d = points[mesh.apex(g)];
    if (orient2d(d, b, c) > 0 && orient2d(c, a, d) > 0) mesh.flip(h);
  }
}

/// Returns the Delaunay triangulation by its definition, which is every triangle whose circle is empty.
std::vector<Corners> by_definition(const std::vector<Vec2>& points) {
  std::vector<Corners> triangles;
  const auto n = static_cast<std::uint32_t>(points.size());
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b)
      for (std::uint32_t c = a + 1; c < n; ++c) {
        if (c == b || orient2d(points[a], points[b], points[c]) <= 0) continue;
        bool is_empty = true;
        for (std::uint32_t d = 0; d < n && is_empty; ++d)
          is_empty = d == a || d == b || d == c || in_circle(points[a], points[b], points[c], points[d]) < 0;
        if (is_empty) triangles.push_back({a, b, c});
      }
  return canonical(triangles);
}

TEST(delaunay_flips, random_points_give_the_triangles_with_empty_circles) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto points = polygons::scattered(seed, 25);
    Triangulation2d mesh = swept(points);
    flip_all(points, mesh);
    EXPECT_EQ(triangles_of(mesh), by_definition(points)) << seed;
  }
}

TEST(delaunay_flips, the_answer_does_not_depend_on_the_triangulation_it_begins_with) {
  for (const auto& points : {polygons::scattered(1, 300), polygons::grid(12, 12), polygons::cocircular(),
                             polygons::turned_grid(12, 12, 0.3), polygons::parabola(40)}) {
    Triangulation2d mesh = swept(points);
    flip_all(points, mesh);
    expect_valid(points, mesh);
    expect_locally_delaunay(points, mesh);
    const auto expected = triangles_of(mesh);
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      shuffle(points, mesh, seed);
      flip_all(points, mesh);
      EXPECT_EQ(triangles_of(mesh), expected);
    }
  }
}

TEST(delaunay_flips, the_diagonal_of_a_square_is_at_its_smallest_corner) {
  const std::vector<Vec2> points = polygons::grid(2, 2);
  Triangulation2d mesh = swept(points);
  flip_all(points, mesh);
  EXPECT_TRUE(edges_of(mesh).count({0, 3}));
}

TEST(delaunay_flips, a_constrained_edge_stays) {
  // A flat quadrilateral whose long diagonal is constrained.
  const std::vector<Vec2> points = {{0, 0}, {4, -1}, {4, 1}, {8, 0}};
  Triangulation2d mesh;
  const std::uint32_t g = mesh.add_triangle(0, 1, 3), h = mesh.add_triangle(3, 2, 0);
  mesh.join(g + 2, h + 2, true);
  flip_all(points, mesh);
  EXPECT_TRUE(edges_of(mesh).count({0, 3}));
  mesh.join(g + 2, h + 2, false);
  flip_all(points, mesh);
  EXPECT_TRUE(edges_of(mesh).count({1, 2}));
}

TEST(delaunay_flips, begun_from_what_has_changed_it_restores_the_whole) {
  const auto points = polygons::scattered(2, 200);
  Triangulation2d mesh = swept(points);
  flip_all(points, mesh);
  const auto expected = triangles_of(mesh);
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    const std::uint32_t g = mesh.twin(h);
    if (g == Triangulation2d::kNoHalfEdge) continue;
    const Vec2 a = points[mesh.from(h)], b = points[mesh.to(h)], c = points[mesh.apex(h)], d = points[mesh.apex(g)];
    if (orient2d(d, b, c) <= 0 || orient2d(c, a, d) <= 0) continue;
    mesh.flip(h);
    std::vector<std::uint32_t> queue{h};
    RunControl control;
    delaunay_flips(points, mesh, queue, control);
    EXPECT_TRUE(queue.empty());
    ASSERT_EQ(triangles_of(mesh), expected);
  }
}

STAGE(delaunay_flips, test::kStop) {
  const auto points = polygons::scattered(1, 20000);
  Triangulation2d mesh = swept(points);
  delaunay_flips(points, mesh, trial.control);
}

}  // namespace
}  // namespace remesh
