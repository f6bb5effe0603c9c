#include "core/refinement/attempt_effort.h"

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

}  // namespace
}  // namespace remesh
