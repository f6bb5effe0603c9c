#include "core/base/loop_progress.h"

#include <gtest/gtest.h>

#include "tests/support/invariance.h"

namespace remesh {
namespace {

TEST(loop_progress, each_item_moves_it_and_loops_one_after_the_other_never_reach_the_end) {
  RunControl control;
  control.enter(Stage::kWeld);
  double before = control.fraction();
  for (int loop = 0; loop < 20; ++loop) {
    LoopProgress progress(control, 10);
    for (int i = 0; i < 10; ++i) {
      progress.add(1);
      EXPECT_GT(control.fraction(), before);
      EXPECT_LT(control.fraction(), 1);
      before = control.fraction();
    }
  }
}

TEST(loop_progress, a_loop_without_items_does_no_harm) {
  RunControl control;
  LoopProgress progress(control, 0);
  progress.add(0);
  EXPECT_EQ(control.fraction(), 0);
}

STAGE(loop_progress, test::kStop) { LoopProgress(trial.control, 10).add(1); }

}  // namespace
}  // namespace remesh
