#include "core/refinement/attempt_effort.h"

#include <gtest/gtest.h>

namespace remesh {
namespace {

/// Returns after how many attempts the effort is used up.
/// Input: the triangles of each attempt, and the steps of the search in its check.
int attempts_until_used_up(std::uint64_t triangles, std::uint64_t steps) {
  AttemptEffort effort(20'000, 0);
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

}  // namespace
}  // namespace remesh
