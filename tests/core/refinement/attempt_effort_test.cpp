#include "core/refinement/attempts/attempt_effort.h"

#include <gtest/gtest.h>

namespace remesh {
namespace {

/// Returns after how many attempts the effort is used up.
/// Input: the triangles of each attempt, and the steps of the search in its check.
int attempts_until_used_up(std::uint64_t triangles, std::uint64_t steps) {
  AttemptEffort effort(20'000, {});
  int attempts = 0;
  for (; !effort.is_used_up(); ++attempts) {
    effort.take(triangles);
    effort.take_check(steps);
  }
  return attempts;
}

TEST(attempt_effort, searches_of_the_usual_length_do_not_count) {
  EXPECT_EQ(attempts_until_used_up(2000, 250 * 2000), 26);
  EXPECT_EQ(attempts_until_used_up(2000, 0), 26);
}

TEST(attempt_effort, long_searches_leave_room_for_a_few_attempts) {
  EXPECT_EQ(attempts_until_used_up(2000, SearchLimits::few_steps_for(20'000)), 5);
}

TEST(attempt_effort, what_was_taken_counts_after_the_faces_were_mended_anew) {
  AttemptEffort before(20'000, {});
  before.take(2000);
  before.take_check(4 * SearchLimits::few_steps_for(20'000));
  EXPECT_FALSE(before.is_used_up());
  AttemptEffort after(20'000, before.all_taken());
  EXPECT_EQ(after.taken(), 2000u);
  EXPECT_TRUE(after.is_any_wrong());
  after.take_check(1);
  EXPECT_TRUE(after.is_used_up());
}

TEST(attempt_effort, two_failures_that_are_large_for_the_mesh_are_enough) {
  for (const bool is_small_mesh : {false, true}) {
    AttemptEffort effort(200'000, {});
    effort.limit_vain_work(is_small_mesh ? 500 : 10'000);
    for (int failures = 1; failures <= 2; ++failures) {
      effort.take(50'000);
      effort.note_wrong();
      effort.begin_attempt(true);
      EXPECT_EQ(effort.has_goals(), failures < 2 || !is_small_mesh) << failures;
    }
  }
}

TEST(attempt_effort, searches_for_gaps_share_a_bound) {
  constexpr std::uint64_t kOne = 1'000'000;
  EXPECT_EQ(work_of_sizes_after(0, kOne), kOne);
  EXPECT_EQ(work_of_sizes_after(kOne / 2, kOne), kOne / 4 * 3);
  EXPECT_EQ(work_of_sizes_after(100 * kOne, kOne), kOne / 8);
  EXPECT_EQ(work_of_sizes_after(100 * kOne, WorkBound::kNone), WorkBound::kNone);
}

}  // namespace
}  // namespace remesh
