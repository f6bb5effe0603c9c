#include "core/geometry/triangles/triangle_intersection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "tests/support/cgal_space.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

Triangle triangle(int a, int b, int c) { return {VertexId(a), VertexId(b), VertexId(c)}; }

/// Expects the same answer for every order of the two triangles and of their corners.
void expect_intersect(const Triangle& f, const Triangle& g, std::span<const Vec3> positions, bool expected) {
  Triangle a = f;
  std::sort(a.begin(), a.end());
  do {
    Triangle b = g;
    std::sort(b.begin(), b.end());
    do {
      ASSERT_EQ(do_intersect(a, b, positions), expected)
          << a[0] << ' ' << a[1] << ' ' << a[2] << " and " << b[0] << ' ' << b[1] << ' ' << b[2];
      ASSERT_EQ(do_intersect(b, a, positions), expected);
    } while (std::next_permutation(b.begin(), b.end()));
  } while (std::next_permutation(a.begin(), a.end()));
}

Triangle random_triangle(Random& random, std::size_t vertices) {
  const int n = static_cast<int>(vertices);
  const int a = random.below(n), b = random.below(n);
  return triangle(a, b, random.below(n));
}

/// How often each case came up: shared corners, whether both have area, the answer.
using Tally = std::map<std::tuple<int, bool, bool>, int>;

/// Compares random pairs of triangles over these points with the oracle. Now and then a corner is repeated.
Tally compare_random_pairs(const std::vector<Vec3>& points, std::uint64_t seed, int pairs) {
  const CgalIntersection oracle(points);
  Random random(seed);
  Tally tally;
  for (int i = 0; i < pairs; ++i) {
    const Triangle f = random_triangle(random, points.size());
    Triangle g = random_triangle(random, points.size());
    // Shared corners more often than by chance.
    for (int k = random.below(4); k > 0; --k) g[k - 1] = f[random.below(3)];
    const bool expected = oracle(f, g);
    expect_intersect(f, g, points, expected);
    if (testing::Test::HasFatalFailure()) return tally;
    const auto shared =
        std::count_if(f.begin(), f.end(), [&](VertexId v) { return std::find(g.begin(), g.end(), v) != g.end(); });
    ++tally[{static_cast<int>(shared), oracle.has_area(f) && oracle.has_area(g), expected}];
  }
  return tally;
}

std::vector<Vec3> grid(int n, int layers) {
  std::vector<Vec3> points;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y)
      for (int z = 0; z < layers; ++z) points.push_back({1.0 * x, 1.0 * y, 1.0 * z});
  return points;
}

TEST(triangle_intersection, pairs_of_a_small_grid_agree_with_the_oracle_in_every_case) {
  Tally tally = compare_random_pairs(grid(4, 4), 1, 8000);
  for (int shared = 0; shared < 4; ++shared)
    for (const bool has_area : {true, false})
      for (const bool expected : {true, false}) {
        // Three shared corners: of a face with area always a duplicate, of one without it always its own edge.
        if (shared == 3 && has_area != expected) continue;
        const int count = tally[{shared, has_area, expected}];
        EXPECT_GT(count, 0) << shared << " shared corners, area " << has_area << ", intersecting " << expected;
      }
}

TEST(triangle_intersection, coplanar_pairs_agree_with_the_oracle) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Vec3> points = grid(5, 1);
    for (Vec3& p : points) p = {p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]};
    compare_random_pairs(points, 2 + axis, 2500);
  }
  // The points are in a plane that is parallel to no axis.
  std::vector<Vec3> points = grid(5, 1);
  for (Vec3& p : points) p.z = 3 * p.x - 2 * p.y;
  compare_random_pairs(points, 5, 2500);
}

TEST(triangle_intersection, collinear_pairs_agree_with_the_oracle) {
  std::vector<Vec3> points;
  for (int i = -4; i < 4; ++i) points.push_back({1.0 * i, -2.0 * i, 3.0 * i});
  Tally tally = compare_random_pairs(points, 6, 2000);
  for (int shared = 0; shared < 3; ++shared)
    for (const bool expected : {true, false}) EXPECT_GT((tally[{shared, false, expected}]), 20) << shared;
}

TEST(triangle_intersection, pairs_in_nearly_one_plane_agree_with_the_oracle) {
  for (int seed = 0; seed < 4; ++seed) {
    const polygons::Placement place = polygons::random_placement(seed, 10);
    std::vector<Vec3> points;
    for (const Vec2 p : polygons::grid(5, 5)) points.push_back(place(p));  // off the plane by rounding
    compare_random_pairs(points, 7 + seed, 1500);
  }
}

TEST(triangle_intersection, the_answer_does_not_change_at_the_ends_of_the_range) {
  std::vector<Vec3> points = grid(4, 4), tiny = points, huge = points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    tiny[i] = 0x1p-250 * points[i];
    huge[i] = 0x1p248 * points[i];
  }
  Random random(11);
  for (int i = 0; i < 20000; ++i) {
    const Triangle f = random_triangle(random, points.size()), g = random_triangle(random, points.size());
    const bool expected = do_intersect(f, g, points);
    ASSERT_EQ(do_intersect(f, g, tiny), expected);
    ASSERT_EQ(do_intersect(f, g, huge), expected);
  }
}

TEST(triangle_intersection, neighbours_meet_only_in_what_they_share) {
  const std::vector<Vec3> p = {{0, 0, 0}, {1, 0, 0},       {0, 1, 0},   {1, 1, 0},
                               {1, 1, 1}, {0.25, 0.25, 0}, {-1, -1, 0}, {1, 1, -1}};
  expect_intersect(triangle(0, 1, 2), triangle(1, 3, 2), p, false);  // across an edge, in one plane
  expect_intersect(triangle(0, 1, 2), triangle(1, 4, 2), p, false);  // the same at an angle
  expect_intersect(triangle(0, 1, 2), triangle(1, 5, 2), p, true);   // folded back
  expect_intersect(triangle(0, 1, 2), triangle(0, 1, 2), p, true);   // a duplicate
  expect_intersect(triangle(0, 1, 2), triangle(0, 6, 4), p, false);  // only a corner is shared
  expect_intersect(triangle(0, 1, 2), triangle(0, 4, 7), p, true);   // the same, but it passes through the face
}

TEST(triangle_intersection, touching_without_sharing_is_intersecting) {
  const std::vector<Vec3> p = {{0, 0, 0},  {4, 0, 0}, {0, 4, 0}, {2, 0, 0}, {2, -1, 0},
                               {3, -1, 1}, {1, 1, 0}, {1, 1, 1}, {2, 2, 1}, {0, 0, 0}};
  expect_intersect(triangle(0, 1, 2), triangle(3, 4, 5), p, true);  // a corner inside an edge: a T-junction
  expect_intersect(triangle(0, 1, 2), triangle(6, 7, 8), p, true);  // a corner inside the face
  expect_intersect(triangle(0, 1, 2), triangle(9, 4, 5), p, true);  // equal coordinates, but another corner
}

TEST(triangle_intersection, a_triangle_without_area_is_its_segment) {
  const std::vector<Vec3> p = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {1, 2, 0}, {1, -2, 0}, {3, 0, 0}, {0, 0, 1}};
  expect_intersect(triangle(0, 1, 2), triangle(0, 1, 3), p, false);  // lies along the shared edge
  expect_intersect(triangle(0, 1, 2), triangle(0, 2, 4), p, false);  // its other half does not concern this face
  expect_intersect(triangle(0, 1, 2), triangle(2, 3, 4), p, false);  // is met in the shared corner only
  expect_intersect(triangle(0, 1, 2), triangle(0, 3, 4), p, true);   // passes through the face
  expect_intersect(triangle(0, 1, 1), triangle(2, 3, 6), p, true);   // is touched by a corner
  expect_intersect(triangle(5, 5, 5), triangle(0, 3, 4), p, false);  // a point beside
}

}  // namespace
}  // namespace remesh
