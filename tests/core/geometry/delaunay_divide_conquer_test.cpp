#include "core/triangulation/delaunay_divide_conquer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/exact/predicates.h"
#include "core/triangulation/delaunay_flips.h"
#include "core/triangulation/lexicographic_triangulation.h"
#include "tests/support/cgal_plane.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

/// Returns the triangles in the order of the triangulation.
std::vector<Corners> triangles(const Triangulation2d& mesh) {
  std::vector<Corners> result;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); h += 3)
    result.push_back({mesh.from(h), mesh.to(h), mesh.apex(h)});
  return result;
}

std::size_t convex_hull_size_with_collinear(const std::vector<Vec2>& points) {
  // Andrew's monotone chain, collinear points kept.
  std::size_t size = 0;
  for (const int side : {1, -1}) {
    std::vector<Vec2> chain;
    for (const Vec2 p : points) {
      while (chain.size() >= 2 && side * orient2d(chain[chain.size() - 2], chain.back(), p) < 0) chain.pop_back();
      chain.push_back(p);
    }
    size += chain.size() - 1;
  }
  return size;
}

/// Expects the Delaunay triangulation. Its triangles run counter-clockwise, are joined to their neighbours, are locally
/// Delaunay, and are as many as Euler's formula says. Ties must fall as in_circle_perturbed says, so that there is only
/// one such triangulation.
void expect_delaunay(const std::vector<Vec2>& points, const Triangulation2d& mesh) {
  std::size_t hull_edges = 0;
  for (std::uint32_t h = 0; h < mesh.half_edge_count(); ++h) {
    ASSERT_GT(orient2d(points[mesh.from(h)], points[mesh.to(h)], points[mesh.apex(h)]), 0);
    const std::uint32_t g = mesh.twin(h);
    if (g == kNoHalfEdge) {
      ++hull_edges;
      continue;
    }
    ASSERT_EQ(mesh.twin(g), h);
    ASSERT_EQ(mesh.from(g), mesh.to(h));
    ASSERT_EQ(mesh.to(g), mesh.from(h));
    ASSERT_LT(in_circle_perturbed(points[mesh.from(h)], points[mesh.to(h)], points[mesh.apex(h)], points[mesh.apex(g)]),
              0);
  }
  const std::size_t on_hull = convex_hull_size_with_collinear(points);
  EXPECT_EQ(hull_edges, on_hull);
  EXPECT_EQ(mesh.triangle_count(), 2 * points.size() - 2 - on_hull);
}

std::vector<Vec2> turned_by_a_quarter(std::vector<Vec2> points) {
  for (Vec2& p : points) p = {-p.y, p.x};
  return polygons::sorted_unique(std::move(points));
}

struct Family {
  std::string name;
  std::vector<Vec2> points;
};

std::vector<Family> degenerate_families() {
  std::vector<Family> families = {
      {"triangle", polygons::sorted_unique({{0, 0}, {1, 0}, {0, 1}})},
      {"square", polygons::grid(2, 2)},
      {"grid", polygons::grid(40, 25)},
      {"thinned grid", polygons::grid(60, 60, 0.3)},
      {"grid of two rows", polygons::grid(300, 2)},
      {"turned grid", polygons::turned_grid(40, 40, 0.3)},
      {"diagonal grid", polygons::turned_grid(40, 40, 0.78539816339744828)},
      {"cocircular", polygons::cocircular()},
      {"nearly cocircular", polygons::nearly_cocircular(2000)},
      {"parabola", polygons::parabola(1000)},
      {"slanting lines", polygons::on_lines(1, 5, 200, 3, 7)},
      {"vertical lines", polygons::on_lines(2, 3, 300, 0, 1)},
      {"horizontal lines", polygons::on_lines(3, 3, 300, 1, 0)},
      {"clusters", polygons::clusters(1, 10, 100)},
  };
  std::vector<Vec2> fan = polygons::on_lines(4, 1, 300, 1, 1);
  fan.push_back({1000, -3});
  families.push_back({"a line and a point", polygons::sorted_unique(fan)});
  return families;
}

TEST(delaunay_divide_conquer, scattered_points_give_the_triangles_of_the_oracle) {
  RunControl control;
  for (const int n : {3, 4, 5, 6, 7, 10, 33, 100, 1000, 20000}) {
    SCOPED_TRACE(n);
    const std::vector<Vec2> points = polygons::scattered(static_cast<std::uint64_t>(n), n);
    const Triangulation2d mesh = delaunay_divide_conquer(points, control);
    EXPECT_EQ(canonical(triangles(mesh)), canonical(cgal_delaunay(points)));
    expect_delaunay(points, mesh);
  }
}

TEST(delaunay_divide_conquer, degenerate_points_give_the_delaunay_triangulation) {
  RunControl control;
  for (const Family& family : degenerate_families()) {
    SCOPED_TRACE(family.name);
    expect_delaunay(family.points, delaunay_divide_conquer(family.points, control));
    const std::vector<Vec2> turned = turned_by_a_quarter(family.points);
    expect_delaunay(turned, delaunay_divide_conquer(turned, control));
  }
}

TEST(delaunay_divide_conquer, sweeping_and_flipping_gives_the_same_triangles) {
  RunControl control;
  for (const Family& family : degenerate_families()) {
    SCOPED_TRACE(family.name);
    Triangulation2d flipped = lexicographic_triangulation(family.points, control);
    delaunay_flips(family.points, flipped, control);
    EXPECT_EQ(canonical(triangles(delaunay_divide_conquer(family.points, control))), canonical(triangles(flipped)));
  }
}

TEST(delaunay_divide_conquer, every_subset_of_a_small_grid_has_its_triangulation) {
  RunControl control;
  const std::vector<Vec2> all = polygons::grid(4, 3);
  for (unsigned subset = 0; subset < 1u << all.size(); ++subset) {
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (subset >> i & 1u) points.push_back(all[i]);
    const Triangulation2d mesh = delaunay_divide_conquer(points, control);
    const bool is_flat = std::all_of(points.begin(), points.end(),
                                     [&](Vec2 p) { return orient2d(points.front(), points.back(), p) == 0; });
    if (is_flat)
      ASSERT_EQ(mesh.triangle_count(), 0u) << subset;
    else
      expect_delaunay(points, mesh);
    ASSERT_FALSE(HasFailure()) << subset;
  }
}

TEST(delaunay_divide_conquer, points_on_one_line_have_no_triangle) {
  RunControl control;
  EXPECT_EQ(delaunay_divide_conquer({}, control).triangle_count(), 0u);
  for (const int n : {1, 2, 3, 4, 5, 50, 5000}) {
    EXPECT_EQ(delaunay_divide_conquer(polygons::grid(1, n), control).triangle_count(), 0u);
    EXPECT_EQ(delaunay_divide_conquer(polygons::grid(n, 1), control).triangle_count(), 0u);
    EXPECT_EQ(delaunay_divide_conquer(polygons::on_lines(5, 1, n, 3, -2), control).triangle_count(), 0u);
  }
}

STAGE(delaunay_divide_conquer, test::kWorkers, test::kScale, test::kStop) {
  std::vector<Family> families = degenerate_families();
  families.push_back({"scattered", polygons::scattered(4, 150'000)});
  for (Family& family : families) {
    for (Vec2& p : family.points) p = trial.scale * p;
    trial.in_order(triangles(delaunay_divide_conquer(family.points, trial.control)));
  }
}

TEST(delaunay_divide_conquer, triangles_begin_at_their_smallest_point_and_follow_its_order) {
  RunControl control;
  const std::vector<Vec2> points = polygons::scattered(3, 3000);
  const std::vector<Corners> list = triangles(delaunay_divide_conquer(points, control));
  for (std::size_t i = 0; i < list.size(); ++i) {
    ASSERT_LT(list[i][0], std::min(list[i][1], list[i][2]));
    if (i == 0) continue;
    ASSERT_LE(list[i - 1][0], list[i][0]);
    // Around one point the next triangle shares the edge at which the last one ends.
    if (list[i - 1][0] == list[i][0]) {
      ASSERT_EQ(list[i - 1][2], list[i][1]);
    }
  }
}

}  // namespace
}  // namespace remesh
