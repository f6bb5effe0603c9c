#include "core/refinement/attempts/refinement_choices.h"

#include <gtest/gtest.h>

#include "core/geometry/intersections/self_intersections.h"

namespace remesh {
namespace {

constexpr std::uint64_t kLimit = 20'000;

RefinementChoices first_choices(std::uint64_t in_proportion = Goals::kNoLimit) {
  Goals goals{};
  goals.faces_without_min_edge = in_proportion;
  goals.lowest_min_edge = 0x1p-10;
  return RefinementChoices(MinEdgeSearch(goals));
}

RefinementFacts facts_with(std::uint64_t max_faces, std::uint64_t in_proportion = Goals::kNoLimit) {
  RefinementFacts facts;
  facts.are_goals_set = facts.is_any_refined = true;
  facts.is_min_edge_automatic = in_proportion != Goals::kNoLimit;
  facts.max_faces = max_faces;
  facts.faces_without_min_edge = in_proportion;
  facts.predicted = 1e6;
  return facts;
}

/// Returns after how many attempts the effort is spent.
/// Input: the triangles of each attempt, and the steps of the search in its check.
int attempts_until_spent(std::uint64_t triangles, std::uint64_t steps) {
  Effort effort;
  int attempts = 0;
  for (; !effort.is_spent(kLimit); ++attempts) {
    effort.triangles += triangles;
    effort.largest = triangles;
    effort.search_steps += steps;
  }
  return attempts;
}

TEST(effort_of_attempts, searches_of_the_usual_length_do_not_count) {
  EXPECT_EQ(attempts_until_spent(2000, 250 * 2000), 26);
  EXPECT_EQ(attempts_until_spent(2000, 0), 26);
}

TEST(effort_of_attempts, long_searches_leave_room_for_a_few_attempts) {
  EXPECT_EQ(attempts_until_spent(2000, SearchLimits::few_steps_for(kLimit)), 5);
}

TEST(effort_of_attempts, two_failures_that_are_large_for_the_mesh_are_enough) {
  for (const bool is_small_mesh : {false, true}) {
    Effort effort;
    effort.max_in_vain = kWorkInVain.steps(is_small_mesh ? 500 : 10'000, 0);
    for (int failures = 1; failures <= 2; ++failures) {
      effort.triangles += 50'000;
      ++effort.wrong;
      EXPECT_EQ(effort.is_in_vain(200'000), failures == 2 && is_small_mesh) << failures;
    }
  }
}

TEST(effort_of_attempts, searches_for_gaps_share_a_bound) {
  constexpr std::uint64_t kOne = 1'000'000;
  EXPECT_EQ(work_of_sizes_after(0, kOne), kOne);
  EXPECT_EQ(work_of_sizes_after(kOne / 2, kOne), kOne / 4 * 3);
  EXPECT_EQ(work_of_sizes_after(100 * kOne, kOne), kOne / 8);
  EXPECT_EQ(work_of_sizes_after(100 * kOne, WorkBound::kNone), WorkBound::kNone);
}

TEST(refinement_choices, a_result_with_few_faces_changes_nothing) {
  const RefinementChoices now = first_choices();
  const AfterFaces after = after_faces(now, kLimit, false, facts_with(kLimit));
  EXPECT_FALSE(after.is_repeated);
  EXPECT_EQ(after.choices, now);
}

TEST(refinement_choices, the_first_result_with_too_many_faces_costs_nothing_and_brings_a_budget) {
  const AfterFaces after = after_faces(first_choices(), kLimit + 1, false, facts_with(kLimit));
  EXPECT_TRUE(after.is_repeated);
  EXPECT_FALSE(after.counts);
  ASSERT_TRUE(after.choices.budget);
  EXPECT_LT(*after.choices.budget, kLimit);
  EXPECT_GT(*after.choices.budget, kLimit / 100 * 99);
}

TEST(refinement_choices, budgets_shrink_until_nothing_is_refined) {
  RefinementChoices choices = first_choices();
  std::uint64_t last = kLimit;
  int attempts = 0;
  for (; !is_budget_too_small(choices); ++attempts) {
    const AfterFaces after = after_faces(choices, kLimit + kLimit / 4, false, facts_with(kLimit));
    ASSERT_TRUE(after.is_repeated);
    EXPECT_LE(*after.choices.budget, last);
    last = *after.choices.budget;
    choices = after.choices;
  }
  EXPECT_LE(attempts, 5) << "retries that save nothing count more";
  EXPECT_FALSE(after_faces(choices, kLimit * 2, false, facts_with(kLimit)).is_repeated);
}

TEST(refinement_choices, a_floor_is_raised_where_faces_are_out_of_proportion_or_angles_get_worse) {
  const RefinementFacts facts = facts_with(1'000'000, kLimit);
  const RefinementChoices now = first_choices(kLimit);
  for (const bool are_angles_worse : {false, true}) {
    const AfterFaces after = after_faces(now, are_angles_worse ? 100 : kLimit + 1, are_angles_worse, facts);
    EXPECT_TRUE(after.is_repeated);
    EXPECT_FALSE(after.counts);
    EXPECT_GT(after.choices.min_edge.min_edge_length(), now.min_edge.min_edge_length());
    EXPECT_EQ(after.choices.too_many_predicted, facts.predicted);
  }
}

TEST(refinement_choices, when_no_floor_is_left_there_is_a_budget) {
  const RefinementFacts facts = facts_with(1'000'000, kLimit);
  RefinementChoices choices = first_choices(kLimit);
  int floors = 0;
  for (; !choices.budget; ++floors) {
    ASSERT_LT(floors, 100);
    choices = after_too_many_made(choices, facts);
  }
  EXPECT_GT(floors, 10);
  EXPECT_TRUE(choices.is_thinning_quick);
}

TEST(target_choice, a_result_that_misses_its_target_is_corrected_once_by_what_it_has_shown) {
  RefinementFacts facts = facts_with(1'000'000);
  facts.over_target = 1.5;
  facts.aimed_over_target = 1.2;
  const AfterFaces after = after_faces(first_choices(), 15'000, false, facts);
  EXPECT_TRUE(after.is_repeated);
  EXPECT_FALSE(after.counts);
  EXPECT_DOUBLE_EQ(after.choices.target.scale, 0.8);
  EXPECT_FALSE(after_faces(after.choices, 15'000, false, facts).is_repeated);
}

TEST(target_choice, a_result_near_its_target_and_one_that_nothing_brings_nearer_are_the_answer) {
  RefinementFacts facts = facts_with(1'000'000);
  for (const double over : {0.91, 1.0, 1.09}) {
    facts.over_target = over;
    EXPECT_FALSE(after_faces(first_choices(), 10'000, false, facts).is_repeated) << over;
  }
  for (const double over : {0.89, 1.11}) {
    facts.over_target = over;
    EXPECT_TRUE(after_faces(first_choices(), 10'000, false, facts).is_repeated) << over;
  }
  facts.over_target.reset();
  EXPECT_FALSE(after_faces(first_choices(), 10'000, false, facts).is_repeated);
}

}  // namespace
}  // namespace remesh
