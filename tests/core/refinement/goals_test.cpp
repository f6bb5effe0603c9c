#include "core/refinement/goals/goals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace remesh {
namespace {

TEST(goals, by_default_it_is_25_degrees_and_nothing_else) {
  const Goals goals = goals_of(Options{}, 10);
  EXPECT_EQ(goals.min_angle_deg, 25);
  EXPECT_TRUE(std::isinf(goals.max_edge_length));
  EXPECT_TRUE(std::isinf(goals.max_area));
  EXPECT_EQ(goals.min_edge_length, 0);
  EXPECT_EQ(goals.proximity, 0);
  EXPECT_EQ(goals.gradation, 0);
  EXPECT_EQ(goals.max_faces, std::numeric_limits<std::uint64_t>::max());
  EXPECT_TRUE(goals.split_boundaries);
}

TEST(goals, without_refinement_there_is_none_but_the_budget) {
  Options options;
  options.refine = false;
  options.min_angle_deg = 30;
  options.max_edge_length = 1;
  options.max_area = 1;
  options.proximity = 1;
  options.gradation = 2;
  options.max_output_faces = 7;
  const Goals goals = goals_of(options, 10);
  EXPECT_EQ(goals.min_angle_deg, 0);
  EXPECT_TRUE(std::isinf(goals.max_edge_length));
  EXPECT_TRUE(std::isinf(goals.max_area));
  EXPECT_EQ(goals.proximity, 0);
  EXPECT_EQ(goals.gradation, 0);
  EXPECT_EQ(goals.max_faces, 7u);
}

TEST(goals, each_option_is_a_goal) {
  Options options;
  options.min_angle_deg = 0;
  options.max_edge_length = 2;
  options.max_area = 3;
  options.min_edge_length = 0.5;
  options.gradation = 1.2;
  options.max_output_faces = 99;
  options.split_boundaries = false;
  const Goals goals = goals_of(options, 10);
  EXPECT_EQ(goals.min_angle_deg, 0);
  EXPECT_EQ(goals.max_edge_length, 2);
  EXPECT_EQ(goals.max_area, 3);
  EXPECT_EQ(goals.min_edge_length, 0.5);
  EXPECT_EQ(goals.gradation, 1.2);
  EXPECT_EQ(goals.max_faces, 99u);
  EXPECT_FALSE(goals.split_boundaries);
}

TEST(goals, a_fraction_is_of_the_diagonal) {
  Options options;
  options.max_edge_fraction = 0.1;
  EXPECT_DOUBLE_EQ(goals_of(options, 30).max_edge_length, 3);
}

TEST(goals, a_radius_edge_ratio_is_one_over_twice_the_sine) {
  Options options;
  for (const double degrees : {5.0, 20.7, 30.0}) {
    options.max_radius_edge_ratio = 1 / (2 * std::sin(degrees * std::numbers::pi / 180));
    EXPECT_NEAR(goals_of(options, 1).min_angle_deg, degrees, 1e-12);
  }
  // The equilateral triangle has 1/sqrt(3), and below a half there is no triangle: as far as the contract goes.
  for (const double ratio : {0.8, 0.55, 0.4, 1e-9}) {
    options.max_radius_edge_ratio = ratio;
    EXPECT_EQ(goals_of(options, 1).min_angle_deg, Goals::kMaxDegrees);
  }
}

TEST(goals, proximity_brings_a_gradation_unless_one_is_given) {
  Options options;
  options.proximity = 2;
  EXPECT_EQ(goals_of(options, 1).proximity, 2);
  EXPECT_EQ(goals_of(options, 1).gradation, 1.5);
  options.gradation = 3;
  EXPECT_EQ(goals_of(options, 1).gradation, 3);
}

}  // namespace
}  // namespace remesh
