#include "core/refinement/sizes/fixed_side_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/geometry/triangles/distances.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

Vec2 random_place(Random& random) { return {random.uniform(-1, 1), random.uniform(-1, 1)}; }

std::vector<FixedSide> random_sides(Random& random, int n) {
  std::vector<FixedSide> sides;
  for (int i = 0; i < n; ++i) {
    const Vec2 from = random_place(random), way = random.uniform(0.01, 0.5) * random_place(random);
    sides.push_back({from, from + way, norm(way) * random.uniform(0.01, 0.9)});
  }
  return sides;
}

TEST(fixed_side_sizes, on_a_side_they_are_its_length_and_far_away_nothing) {
  RunControl control;
  for (const double angle : {0.0, 25.0, 33.0}) {
    const std::vector<FixedSide> sides{{{0, 0}, {2, 0}, 0.1}};
    const FixedSideSizes sizes(sides, angle, control);
    for (const double x : {0.0, 0.3, 1.0, 2.0}) EXPECT_EQ(sizes.at({x, 0}), 2);
    EXPECT_EQ(sizes.at({1, 1.2}), 0);
    EXPECT_GT(sizes.at({1, 0.1}), sizes.at({1, 0.2}));
    EXPECT_EQ(sizes.at({1, 0.2}), sizes.at({1, -0.2}));
  }
}

TEST(fixed_side_sizes, the_size_that_is_asked_for_is_reached_as_far_away_whatever_it_is) {
  RunControl control;
  for (const double size : {1.9, 1.0, 0.1, 0.001}) {
    const std::vector<FixedSide> sides{{{0, 0}, {2, 0}, size}};
    const FixedSideSizes sizes(sides, 25, control);
    EXPECT_GT(sizes.at({1, 0.6}), size);
    EXPECT_LT(sizes.at({1, 0.75}), size);
  }
}

TEST(fixed_side_sizes, of_many_sides_the_largest_counts) {
  RunControl control;
  Random random(1);
  const std::vector<FixedSide> sides = random_sides(random, 100);
  const FixedSideSizes all(sides, 25, control);
  std::vector<FixedSide> turned(sides.rbegin(), sides.rend());
  const FixedSideSizes backwards(turned, 25, control);
  for (int i = 0; i < 2000; ++i) {
    const Vec2 p = random_place(random);
    double largest = 0;
    for (const FixedSide& side : sides)
      largest = std::max(largest, FixedSideSizes(std::span(&side, 1), 25, control).at(p));
    EXPECT_EQ(all.at(p), largest);
    EXPECT_EQ(backwards.at(p), largest);
  }
}

TEST(fixed_side_sizes, what_is_allowed_around_a_place_is_necessary_at_all_places_there) {
  RunControl control;
  Random random(2);
  const std::vector<FixedSide> sides = random_sides(random, 10);
  const FixedSideSizes sizes(sides, 25, control);
  int allowed = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec2 p = random_place(random);
    const double radius = random.uniform(0, 0.1), length = random.uniform(0, 0.3);
    if (!sizes.allow(length, p, radius)) continue;
    ++allowed;
    for (int k = 0; k < 10; ++k) EXPECT_GE(sizes.at(p + (radius / 1.5) * random_place(random)), length * (1 - 1e-12));
  }
  EXPECT_GT(allowed, 100);
}

}  // namespace
}  // namespace remesh
