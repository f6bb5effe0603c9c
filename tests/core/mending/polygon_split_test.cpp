#include "core/mending/polygons/polygon_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/geometry/planes/projection.h"
#include "tests/support/polygons.h"

namespace remesh {
namespace {

std::vector<Vec3> raised(const std::vector<Vec2>& points, double z = 0) {
  std::vector<Vec3> result;
  for (const Vec2 p : points) result.push_back({p.x, p.y, z});
  return result;
}

PolygonSplit split(const std::vector<Vec3>& points, double tolerance = 1e-9) {
  RunControl control;
  return split_polygon(points, tolerance, control);
}

double area_of(const std::vector<Vec3>& points, const PolygonSplit& result) {
  double area = 0;
  for (const auto& [a, b, c] : result.triangles) area += norm(cross(points[b] - points[a], points[c] - points[a])) / 2;
  return area;
}

TEST(polygon_split, a_square_is_two_triangles) {
  const auto points = raised({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const PolygonSplit result = split(points);
  EXPECT_EQ(result.kind, PolygonKind::kPlanar);
  EXPECT_EQ(result.triangles.size(), 2u);
  EXPECT_DOUBLE_EQ(area_of(points, result), 1);
}

TEST(polygon_split, the_diagonal_of_a_convex_quadrilateral_is_the_delaunay_one) {
  // Flat and wide: the short diagonal joins corners 1 and 3, wherever the polygon begins.
  const std::vector<Vec2> rhombus = {{-4, 0}, {0, -1}, {4, 0}, {0, 1}};
  for (std::size_t first = 0; first < 4; ++first) {
    std::vector<Vec2> turned = rhombus;
    std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
    const auto points = raised(turned);
    const PolygonSplit result = split(points);
    ASSERT_EQ(result.triangles.size(), 2u);
    for (const auto& t : result.triangles) {
      const auto high = std::count_if(t.begin(), t.end(), [&](std::uint32_t c) { return points[c].x == 0; });
      EXPECT_EQ(high, 2) << first;
    }
  }
}

/// Splits a polygon and returns each triangle as the set of its points.
std::set<std::set<Vec3>> triangles_of(const std::vector<Vec3>& points) {
  std::set<std::set<Vec3>> triangles;
  for (const auto& [a, b, c] : split(points).triangles) triangles.insert({points[a], points[b], points[c]});
  return triangles;
}

TEST(polygon_split, the_triangles_depend_neither_on_where_a_polygon_begins_nor_on_which_way_it_runs) {
  std::vector<std::vector<Vec3>> polygons = {
      raised({{0, 0}, {1, 0}, {1, 1}, {0, 1}}),
      {{1.2, 0, 0}, {0.8, 1, 0}, {1.2, 1, 1}, {0.8, 0, 1}},
      // A hexagon of cocircular points, bent; one that crosses itself; one with a bridge to a hole.
      {{-1, 0, 0.1}, {-0.5, 1, 0}, {0.5, 1, 0.1}, {1, 0, 0}, {0.5, -1, 0.1}, {-0.5, -1, 0}},
      raised({{3, 1}, {3, 0}, {0, 2}, {0, 0}, {1, 5}}),
      raised({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}})};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const polygons::Loop loop = polygons::grown(seed, 20, 12).outer;
    const polygons::Placement place = polygons::random_placement(seed, 10);
    std::vector<Vec3> points;
    for (const Vec2 p : loop) points.push_back(place(p));
    if (points.size() > 3) polygons.push_back(points);
  }
  for (const std::vector<Vec3>& polygon : polygons) {
    const auto expected = triangles_of(polygon);
    std::vector<Vec3> points = polygon;
    for (std::size_t first = 0; first < points.size(); ++first) {
      std::rotate(points.begin(), points.begin() + 1, points.end());
      EXPECT_EQ(triangles_of(points), expected) << first;
      EXPECT_EQ(triangles_of({points.rbegin(), points.rend()}), expected) << first;
    }
  }
}

TEST(polygon_split, triangles_run_the_way_of_their_polygon) {
  const std::vector<Vec3> points = {{1.2, 0, 0}, {0.8, 1, 0}, {1.2, 1, 1}, {0.8, 0, 1}};
  for (const auto& polygon : {points, std::vector<Vec3>(points.rbegin(), points.rend())})
    for (const auto& [a, b, c] : split(polygon).triangles)
      EXPECT_GT(dot(cross(polygon[b] - polygon[a], polygon[c] - polygon[a]), newell_normal(polygon)), 0);
}

TEST(polygon_split, random_simple_polygons_are_cut_into_n_minus_2_triangles_of_their_area) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const polygons::Loop loop = polygons::grown(seed, 30, 12).outer;
    if (loop.size() < 4) continue;
    const polygons::Placement place = polygons::random_placement(seed, 10);
    std::vector<Vec3> points;
    for (const Vec2 p : loop) points.push_back(place(p));
    const PolygonSplit result = split(points, 1e-9 * 100);
    EXPECT_EQ(result.kind, PolygonKind::kPlanar) << seed;
    const Vec3 normal = normalized(newell_normal(points));
    double area = 0;
    for (const auto& [a, b, c] : result.triangles) {
      const double twice = dot(cross(points[b] - points[a], points[c] - points[a]), normal);
      EXPECT_GT(twice, 0) << seed;
      area += twice / 2;
    }
    EXPECT_EQ(result.triangles.size(), loop.size() - 2) << seed;
    EXPECT_NEAR(area / norm(newell_normal(points)), 0.5, 1e-12) << seed;
  }
}

TEST(polygon_split, a_bridge_to_a_hole_is_no_crossing) {
  const auto points = raised({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}});
  const PolygonSplit result = split(points);
  EXPECT_EQ(result.kind, PolygonKind::kPlanar);
  EXPECT_EQ(result.triangles.size(), 8u);
  EXPECT_DOUBLE_EQ(area_of(points, result), 48);
}

TEST(polygon_split, a_bent_polygon_is_not_planar_and_its_triangles_pass_through_its_corners) {
  const std::vector<Vec3> points = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0.25}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0.25}};
  const PolygonSplit result = split(points);
  EXPECT_EQ(result.kind, PolygonKind::kNotPlanar);
  EXPECT_EQ(result.triangles.size(), 4u);
}

TEST(polygon_split, the_tolerance_is_the_largest_distance_from_the_plane_that_counts_as_flat) {
  // z alternates by +-h about the plane z = 0, which is the best one by symmetry.
  const std::vector<Vec3> points = {{0, 0, 0.125}, {1, 0, -0.125}, {1, 1, 0.125}, {0, 1, -0.125}};
  EXPECT_EQ(split(points, 0.125).kind, PolygonKind::kPlanar);
  EXPECT_EQ(split(points, 0.124).kind, PolygonKind::kNotPlanar);
}

TEST(polygon_split, a_polygon_that_crosses_itself_is_a_fan_from_its_smallest_corner) {
  const auto points = raised({{3, 1}, {3, 0}, {0, 2}, {0, 0}});
  const PolygonSplit result = split(points);
  EXPECT_EQ(result.kind, PolygonKind::kSelfCrossing);
  ASSERT_EQ(result.triangles.size(), 2u);
  for (const auto& t : result.triangles) EXPECT_EQ(t[0], 3u);
}

TEST(polygon_split, a_polygon_of_two_crossing_spikes_is_no_pair_of_large_triangles) {
  // The first and the third corner are nearly one. From the smallest corner, the triangles would cover 400.
  const std::vector<Vec3> points{
      {2.00000003, 1.3e-6, 2.00000003}, {0, 3e-6, 1.99999997}, {1.99999997, 8.4e-7, 1.99999997}, {2.00000003, 200, 2}};
  for (std::size_t shift = 0; shift < points.size(); ++shift)
    for (const bool is_reversed : {false, true}) {
      std::vector<Vec3> turned = points;
      std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(shift), turned.end());
      if (is_reversed) std::reverse(turned.begin(), turned.end());
      const PolygonSplit result = split(turned, 2e-7);
      EXPECT_EQ(result.kind, PolygonKind::kSelfCrossing);
      EXPECT_LT(area_of(turned, result), 1e-4);
    }
}

TEST(polygon_split, a_polygon_that_runs_clockwise_in_no_plane_is_told_from_one_without_area) {
  const auto there_and_back = raised({{0, 0}, {1, 0}, {1, 1}, {1, 0}});
  EXPECT_EQ(split(there_and_back).kind, PolygonKind::kSelfCrossing);
}

TEST(polygon_split, a_spike_that_runs_outwards_is_cut_off_and_one_that_runs_inwards_is_a_slit) {
  const auto outwards = raised({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 4}, {6, 3}, {0, 3}});
  const PolygonSplit cut = split(outwards);
  EXPECT_EQ(cut.kind, PolygonKind::kPlanar);
  EXPECT_DOUBLE_EQ(area_of(outwards, cut), 27);
  EXPECT_TRUE(cut.has_spikes());
  const auto inwards = raised({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 1}, {6, 3}, {0, 3}});
  const PolygonSplit slit = split(inwards);
  EXPECT_EQ(slit.kind, PolygonKind::kPlanar);
  EXPECT_DOUBLE_EQ(area_of(inwards, slit), 27);
  EXPECT_FALSE(slit.has_spikes());
}

TEST(polygon_split, a_spike_out_of_the_plane_is_no_tent_wherever_its_tip_is_above_the_polygon) {
  for (const Vec3& tip : {Vec3{5, 2, 1}, {5, 2, -1}, {5, 2, 1e-6}, {6, 3, 1}, {7, 5, 1}, {6, 3, -9}, {0, 0, 4}})
    for (std::uint64_t seed = 0; seed <= 5; ++seed) {
      const polygons::Placement place = seed == 0 ? polygons::Placement() : polygons::random_placement(seed, 1);
      const Vec3 normal = cross(place.x_axis, place.y_axis);
      std::vector<Vec3> points;
      for (const Vec3& p : {Vec3{0, 0, 0}, {9, 0, 0}, {9, 3, 0}, {6, 3, 0}, tip, {6, 3, 0}, {0, 3, 0}})
        points.push_back(place({p.x, p.y}) + p.z * normal);
      for (const double tolerance : {0.0, 1e-9}) {
        const PolygonSplit result = split(points, tolerance);
        EXPECT_TRUE(result.has_spikes()) << tip.x << ' ' << tip.z << ' ' << seed;
        EXPECT_NEAR(area_of(points, result), 27, 1e-12) << tip.x << ' ' << tip.z << ' ' << seed;
        for (const auto& t : result.triangles)
          EXPECT_EQ(std::count(t.begin(), t.end(), 4u), 0) << tip.x << ' ' << tip.z << ' ' << seed;
      }
    }
}

TEST(polygon_split, a_narrow_spike_out_of_the_plane_is_cut_off_though_narrow_slits_stay) {
  for (const double width : {1e-12, -1e-12}) {
    const std::vector<Vec3> points = {{0, 0, 0}, {9, 0, 0},         {9, 3, 0}, {6, 3, 0},
                                      {5, 2, 1}, {6 + width, 3, 0}, {0, 3, 0}};
    const PolygonSplit result = split(points, 1e-9);
    EXPECT_EQ(result.kind, PolygonKind::kPlanar);
    EXPECT_NEAR(area_of(points, result), 27, 1e-9);
  }
}

TEST(polygon_split, a_slit_beside_a_spike_out_of_the_plane_stays) {
  const std::vector<Vec3> points = {{0, 0, 0}, {9, 0, 0}, {9, 3, 0}, {8, 3, 0}, {8, 1, 0},
                                    {8, 3, 0}, {6, 3, 0}, {5, 2, 1}, {6, 3, 0}, {0, 3, 0}};
  const PolygonSplit result = split(points);
  EXPECT_EQ(result.kind, PolygonKind::kPlanar);
  EXPECT_DOUBLE_EQ(area_of(points, result), 27);
  // Its tip is a corner of triangles.
  EXPECT_TRUE(std::any_of(result.triangles.begin(), result.triangles.end(),
                          [](const auto& t) { return std::count(t.begin(), t.end(), 4u) > 0; }));
}

TEST(polygon_split, a_slit_that_is_narrower_than_the_tolerance_stays_open) {
  for (const double width : {1e-13, 1e-10}) {
    const auto inwards = raised({{0, 0}, {9, 0}, {9, 3}, {6 + width, 3}, {6 + width, 1}, {6, 1}, {6, 3}, {0, 3}});
    const PolygonSplit slit = split(inwards, 1e-9);
    EXPECT_EQ(slit.kind, PolygonKind::kPlanar) << width;
    EXPECT_FALSE(slit.has_spikes()) << width;
    EXPECT_EQ(slit.triangles.size(), 6u) << width;
    const auto outwards = raised({{0, 0}, {9, 0}, {9, 3}, {6 + width, 3}, {6 + width, 5}, {6, 5}, {6, 3}, {0, 3}});
    EXPECT_TRUE(split(outwards, 1e-9).has_spikes()) << width;
  }
}

TEST(polygon_split, a_polygon_that_is_hardly_higher_than_the_tolerance_is_no_spike) {
  for (const double height : {0.5e-9, 1e-9, 3e-9}) {
    const auto strip = raised({{0, 0}, {9, 0}, {9, height}, {4, height}, {0, height}});
    EXPECT_FALSE(split(strip, 1e-9).has_spikes()) << height;
  }
}

TEST(polygon_split, corners_above_each_other_are_a_crossing) {
  // A closed helix of two turns: in its best plane it runs over itself.
  std::vector<Vec3> points;
  for (int i = 0; i < 8; ++i) {
    const Vec2 square[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    points.push_back({square[i % 4].x, square[i % 4].y, 0.125 * std::min(i, 8 - i)});
  }
  EXPECT_EQ(split(points, 10).kind, PolygonKind::kSelfCrossing);
}

}  // namespace
}  // namespace remesh
