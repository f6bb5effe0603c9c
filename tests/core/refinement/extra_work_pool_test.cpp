#include "core/refinement/rounds/extra_work_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace remesh {
namespace {

TEST(steps_above_bounds, a_patch_gets_more_than_an_even_share_until_none_are_left) {
  for (const std::size_t patches : {1, 7, 1000}) {
    ExtraWorkPool steps;
    std::uint64_t taken = 0, rounds = 0;
    for (steps.begin_round(patches); steps.of_turn() > 0; steps.begin_round(patches), ++rounds) {
      EXPECT_GT(steps.of_turn(), (kWorkAboveBounds - std::min(kWorkAboveBounds, taken)) / patches);
      // One patch takes all of its share, and the others need nothing.
      steps.take(steps.of_turn());
      taken += steps.of_turn();
    }
    EXPECT_GE(taken, kWorkAboveBounds);
    EXPECT_LT(rounds, 200u);
  }
}

TEST(steps_above_bounds, if_many_patches_take_their_share_none_is_left_after_the_round) {
  ExtraWorkPool steps;
  steps.begin_round(1000);
  for (int i = 0; i < 1000; ++i) steps.take(steps.of_turn());
  steps.begin_round(1000);
  EXPECT_EQ(steps.of_turn(), 0u);
}

}  // namespace
}  // namespace remesh
