#include "core/mending/polygons/polygon_spikes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/geometry/planes/projection.h"
#include "tests/support/polygons.h"

namespace remesh {
namespace {

std::vector<Vec3> lifted(const std::vector<Vec2>& points) {
  std::vector<Vec3> result;
  for (const Vec2 p : points) result.push_back({p.x, p.y, 0});
  return result;
}

std::vector<Vec3> outline_of(const std::vector<Vec3>& points, double tolerance = 0,
                             Reversals reversals = Reversals::kCut) {
  const RunControl control;
  const Spikes spikes = cut_spikes(points, tolerance, reversals, control);
  if (spikes.needles.empty()) return points;
  std::vector<Vec3> outline;
  for (const std::uint32_t i : spikes.outline) outline.push_back(points[i]);
  return outline;
}

double area_of(const std::vector<Vec3>& loop) { return norm(newell_normal(loop)) / 2; }

TEST(cut_spikes, a_polygon_without_spikes_stays_whole) {
  const auto points = lifted({{0, 0}, {4, 0}, {4, 1}, {2, 1}, {2, 2}, {0, 2}});
  EXPECT_EQ(outline_of(points, 1e-3), points);
  const RunControl control;
  EXPECT_TRUE(cut_spikes(points, 1e-3, Reversals::kCut, control).needles.empty());
}

TEST(cut_spikes, a_corner_on_a_straight_line_is_no_spike) {
  const auto points = lifted({{0, 0}, {2, 0}, {4, 0}, {4, 1}, {0, 1}});
  EXPECT_EQ(outline_of(points, 1e-3), points);
}

TEST(cut_spikes, a_spike_of_several_corners_goes_down_to_its_foot) {
  const auto points = lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 4}, {7, 5}, {6, 6}, {7, 5}, {6, 4}, {6, 3}, {0, 3}});
  EXPECT_EQ(outline_of(points), lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {0, 3}}));
  EXPECT_EQ(outline_of(points, 0, Reversals::kKeep), points);
}

TEST(cut_spikes, spikes_on_a_spike_go_with_it) {
  const auto points =
      lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 5}, {5, 6}, {6, 5}, {7, 6}, {8, 6}, {7, 6}, {6, 5}, {6, 3}, {0, 3}});
  EXPECT_EQ(outline_of(points), lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {0, 3}}));
}

TEST(cut_spikes, one_that_comes_back_a_part_of_the_way_is_cut_to_that_part) {
  const auto points = lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 5}, {6, 4}, {0, 3}});
  const RunControl control;
  const Spikes spikes = cut_spikes(points, 0, Reversals::kKeep, control);
  EXPECT_EQ(spikes.outline, (std::vector<std::uint32_t>{0, 1, 2, 3, 5, 6}));
  EXPECT_EQ(spikes.needles, (std::vector<std::array<std::uint32_t, 3>>{{3, 4, 5}}));
}

TEST(cut_spikes, an_overshoot_along_an_edge_is_cut) {
  const auto points = lifted({{0, 0}, {9, 0}, {9, 3}, {4, 3}, {6, 3}, {0, 3}});
  const auto outline = outline_of(points, 0, Reversals::kKeep);
  EXPECT_EQ(outline.size(), 5u);
  EXPECT_DOUBLE_EQ(area_of(outline), 27);
}

TEST(cut_spikes, of_nothing_but_a_spike_nothing_is_left) {
  EXPECT_TRUE(outline_of(lifted({{0, 0}, {1, 0}, {1, 1}, {1, 0}})).empty());
  EXPECT_TRUE(outline_of(lifted({{0, 0}, {1, 0}, {2, 1}, {3, 3}, {2, 1}, {1, 0}})).empty());
  EXPECT_TRUE(outline_of(lifted({{0, 0}, {4, 0}, {1, 0}, {2, 0}})).empty());
}

TEST(cut_spikes, the_tolerance_decides_how_far_the_way_back_may_be_from_the_way_out) {
  for (const double off : {1e-3, -1e-3}) {
    const auto points = lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 5}, {6 + off, 4}, {0, 3}});
    EXPECT_EQ(outline_of(points, 0.9e-3).size(), 7u) << off;
    EXPECT_EQ(outline_of(points, 1.1e-3).size(), 6u) << off;
  }
}

TEST(cut_spikes, corners_within_the_tolerance_of_each_other_are_one_tip_and_one_foot) {
  const auto points = lifted({{0, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 5}, {5.9999, 5}, {5.9999, 3}, {0, 3}});
  EXPECT_EQ(outline_of(points, 1e-3).size(), 5u);
  EXPECT_EQ(outline_of(points, 1e-5).size(), 8u);
}

TEST(cut_spikes, random_spikes_on_random_polygons_are_found_wherever_the_corners_begin) {
  int spiked = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const polygons::Loop loop = polygons::grown(seed, 20, 12).outer;
    const polygons::Placement place = polygons::random_placement(seed, 10);
    std::vector<Vec3> sound;
    for (const Vec2 p : loop) sound.push_back(place(p));
    if (sound.size() < 4 || outline_of(sound, 0) != sound) continue;
    ++spiked;
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_real_distribution<double> anywhere(-100, 100);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < sound.size(); ++i) {
      points.push_back(sound[i]);
      // Each spike runs out over some places and back over the same ones.
      std::vector<Vec3> way;
      for (std::size_t k = random() % 4; k > 0; --k)
        way.push_back({anywhere(random), anywhere(random), anywhere(random)});
      points.insert(points.end(), way.begin(), way.end());
      if (way.empty()) continue;
      points.insert(points.end(), way.rbegin() + 1, way.rend());
      points.push_back(sound[i]);
    }
    for (std::size_t first = 0; first < points.size(); first += 5) {
      std::vector<Vec3> turned = points;
      std::rotate(turned.begin(), turned.begin() + static_cast<std::ptrdiff_t>(first), turned.end());
      std::vector<Vec3> outline = outline_of(turned, 1e-9), expected = sound;
      ASSERT_EQ(outline.size(), sound.size()) << "seed " << seed << ", first " << first;
      std::rotate(outline.begin(), std::min_element(outline.begin(), outline.end()), outline.end());
      std::rotate(expected.begin(), std::min_element(expected.begin(), expected.end()), expected.end());
      EXPECT_EQ(outline, expected);
    }
  }
  EXPECT_GT(spiked, 10);
}

/// Makes a rectangle of 9 x 3 in the plane z = 0. Its upper side is the given way, which runs from right to left.
std::vector<Vec3> rectangle_with(const std::vector<Vec3>& upper) {
  std::vector<Vec3> loop{{0, 0, 0}, {9, 0, 0}, {9, 3, 0}};
  loop.insert(loop.end(), upper.begin(), upper.end());
  loop.push_back({0, 3, 0});
  return loop;
}

/// Returns what is left of a rectangle's upper side when the spikes out of its plane are cut off.
std::vector<Vec3> upper_side_of(const std::vector<Vec3>& points, double plane_tolerance = 1e-6) {
  const RunControl control;
  const Spikes spikes = cut_spikes_out_of_plane(points, 1e-9, plane_tolerance, control).spikes;
  std::vector<Vec3> outline;
  for (const std::uint32_t i : spikes.outline) outline.push_back(points[i]);
  if (spikes.needles.empty()) outline = points;
  return {outline.begin() + 3, outline.end() - 1};
}

TEST(cut_spikes_out_of_plane, a_slit_in_the_plane_stays_and_a_spike_out_of_it_goes) {
  const auto points = rectangle_with({{8, 3, 0}, {8, 1, 0}, {8, 3, 0}, {6, 3, 0}, {5, 2, 1}, {6, 3, 0}});
  EXPECT_EQ(upper_side_of(points), (std::vector<Vec3>{{8, 3, 0}, {8, 1, 0}, {8, 3, 0}, {6, 3, 0}}));
}

TEST(cut_spikes_out_of_plane, of_two_at_one_foot_each_is_judged_by_itself) {
  for (const bool is_slit_first : {true, false}) {
    const Vec3 foot{6, 3, 0}, slit{6, 1, 0}, spike{5, 2, 1};
    const auto points = rectangle_with({foot, is_slit_first ? slit : spike, foot, is_slit_first ? spike : slit, foot});
    EXPECT_EQ(upper_side_of(points), (std::vector<Vec3>{foot, slit, foot})) << is_slit_first;
  }
}

TEST(cut_spikes_out_of_plane, what_comes_back_into_the_plane_beyond_a_corner_out_of_it_goes_with_that_corner) {
  const auto points = rectangle_with({{6, 3, 0}, {5, 2, 1}, {4, 1, 0}, {5, 2, 1}, {6, 3, 0}});
  EXPECT_EQ(upper_side_of(points), (std::vector<Vec3>{{6, 3, 0}}));
}

TEST(cut_spikes_out_of_plane, the_part_of_a_way_before_it_leaves_the_plane_stays) {
  const auto points = rectangle_with({{6, 3, 0}, {5, 2, 0}, {4, 1, 1}, {5, 2, 0}, {6, 3, 0}});
  EXPECT_EQ(upper_side_of(points), (std::vector<Vec3>{{6, 3, 0}, {5, 2, 0}, {6, 3, 0}}));
}

TEST(cut_spikes_out_of_plane, the_tolerance_decides_how_far_a_tip_may_be_from_the_plane) {
  const auto points = rectangle_with({{6, 3, 0}, {5, 2, 1e-3}, {6, 3, 0}});
  EXPECT_EQ(upper_side_of(points, 0.9e-3).size(), 1u);
  EXPECT_EQ(upper_side_of(points, 1.1e-3).size(), 3u);
}

TEST(cut_spikes_out_of_plane, a_bent_outline_has_its_own_corners_for_a_reach) {
  // The corners alternate by 0.1 about their best plane, which is z = 0.1 by symmetry.
  const auto bent = [](double tip) {
    return std::vector<Vec3>{{0, 0, 0}, {1, 0, 0.2}, {1, 1, 0}, {0.5, 0.5, tip}, {1, 1, 0}, {0, 1, 0.2}};
  };
  EXPECT_EQ(upper_side_of(bent(0.15)).size(), 2u);
  EXPECT_EQ(upper_side_of(bent(0.25)).size(), 0u);
  EXPECT_EQ(upper_side_of(bent(-0.05)).size(), 0u);
}

}  // namespace
}  // namespace remesh
