#include "core/verify/model/outline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/polygons.h"

namespace remesh::verification {
namespace {

SimpleOutline outline_in(const polygons::Placement& place, const std::vector<Vec2>& corners, double tolerance = 1e-9) {
  std::vector<Vec3> loop;
  for (const Vec2 p : corners) loop.push_back(place(p));
  const RunControl control;
  return {loop, normalized(cross(place.x_axis, place.y_axis)), tolerance, control};
}

bool is_simple(const SimpleOutline& outline) {
  RunControl control;
  return outline.is_simple(control);
}

/// A point with whole coordinates, so that all that follows is exact.
struct Point {
  std::int64_t x, y;
};

std::int64_t turn(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

bool is_between(const Point& a, const Point& b, const Point& p) {
  return turn(a, b, p) == 0 && std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

/// Returns whether a polygon neither crosses nor touches itself. It tests all pairs of a corner and an edge, and all
/// pairs of edges.
bool is_simple_by_all_pairs(const std::vector<Point>& loop) {
  const std::size_t n = loop.size();
  const auto sign = [](std::int64_t x) { return (x > 0) - (x < 0); };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const Point &a = loop[i], &b = loop[(i + 1) % n], &c = loop[j], &d = loop[(j + 1) % n];
      if (j != i && j != (i + 1) % n && is_between(a, b, c)) return false;
      if (sign(turn(a, b, c)) * sign(turn(a, b, d)) < 0 && sign(turn(c, d, a)) * sign(turn(c, d, b)) < 0) return false;
    }
  return true;
}

TEST(simple_outline, agrees_with_all_pairs_of_edges_on_random_polygons_in_any_place) {
  int simple = 0, others = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    // Few corners at random whole places are simple often enough; the grown polygons are always, until a corner moves.
    std::vector<Point> loop;
    if (seed % 2 == 0) {
      for (std::size_t i = 0; i < 3 + seed % 5; ++i)
        loop.push_back({static_cast<std::int64_t>(random() % 9), static_cast<std::int64_t>(random() % 9)});
    } else {
      for (const Vec2 p : polygons::grown(seed, 40, 16).outer)
        loop.push_back({std::llround(p.x * 16), std::llround(p.y * 16)});
      if (seed % 4 == 1) loop[random() % loop.size()] = loop[random() % loop.size()];
    }
    std::vector<Vec2> corners;
    for (const Point& p : loop) corners.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
    const bool is_expected = is_simple_by_all_pairs(loop);
    ++(is_expected ? simple : others);
    for (std::uint64_t k = 0; k < 3; ++k) {
      const auto place = k == 0 ? polygons::Placement() : polygons::random_placement(seed + 1000 * k, 1);
      EXPECT_EQ(is_simple(outline_in(place, corners)), is_expected) << "seed " << seed << ", place " << k;
    }
  }
  EXPECT_GT(simple, 50);
  EXPECT_GT(others, 50);
}

TEST(simple_outline, a_corner_within_the_tolerance_of_an_edge_counts_as_on_it) {
  const std::vector<Vec2> corners{{0, 0}, {4, 0}, {4, 2}, {2, 0.01}, {0, 2}};
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_TRUE(is_simple(outline_in(polygons::random_placement(seed, 1), corners, 0.009)));
    EXPECT_FALSE(is_simple(outline_in(polygons::random_placement(seed, 1), corners, 0.011)));
  }
}

std::vector<Vec2> circle(int n) {
  std::vector<Vec2> corners;
  for (int i = 0; i < n; ++i)
    corners.push_back({std::cos(2 * std::acos(-1.0) * i / n), std::sin(2 * std::acos(-1.0) * i / n)});
  return corners;
}

TEST(simple_outline, compares_a_few_pairs_an_edge_where_the_edges_are_apart_along_one_axis) {
  // A line across a circle meets two edges, or four where it goes through corners. So does the end of an edge.
  EXPECT_LE(outline_in({}, circle(20000)).pair_count(), 20000u * 4);
  // All the teeth of a comb are beside each other along one axis, and one after another along the other one.
  const std::vector<Vec2> comb = polygons::comb(2000, 1000).outer;
  for (const bool is_lying : {false, true}) {
    polygons::Placement place;
    if (is_lying) std::swap(place.x_axis, place.y_axis);
    EXPECT_LE(outline_in(place, comb).pair_count(), comb.size() * 8) << is_lying;
  }
}

TEST(simple_outline, never_compares_more_than_all_pairs) {
  // The zigzag's edges lie beside each other along all axes.
  std::vector<Vec2> zigzag;
  for (int i = 0; i < 500; ++i) zigzag.push_back({i % 2 * 1000.0 + i * 0.1, i % 2 * 1000.0 - i * 0.1});
  zigzag.push_back({-1, -1000});
  const std::uint64_t n = zigzag.size(), count = outline_in({}, zigzag).pair_count();
  EXPECT_LE(count, n * (n - 1) / 2);
  EXPECT_GT(count, n * n / 4);
  EXPECT_TRUE(is_simple(outline_in({}, zigzag)));
}

STAGE(simple_outline, test::kWorkers) {
  std::vector<Vec2> corners = circle(20000);
  const bool is_round_simple = is_simple(outline_in({}, corners));
  std::swap(corners[19000], corners[19003]);
  trial.same("round", is_round_simple, "crossing", is_simple(outline_in({}, corners)));
  EXPECT_TRUE(is_round_simple);
}

STAGE(outline_of_corners, test::kStop) {
  SimpleOutline({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 1}, 0, trial.control);
}

STAGE(is_simple_outline, test::kStop) { (void)outline_in({}, circle(2000)).is_simple(trial.control); }

}  // namespace
}  // namespace remesh::verification
