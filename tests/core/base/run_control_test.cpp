#include "core/base/run_control.h"

#include <gtest/gtest.h>

#include <functional>
#include <thread>

namespace remesh {
namespace {

Code code_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error.code;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Code::kInternal;
}

TEST(run_control, nothing_stops_work_that_nobody_asked_to_stop) {
  RunControl control;
  EXPECT_NO_THROW(control.check());
  EXPECT_NO_THROW(control.enter(Stage::kWeld));
  EXPECT_NO_THROW(control.progress(0.5));
  EXPECT_FALSE(control.is_stopped());
}

TEST(run_control, every_point_of_cancellation_ends_with_the_reason) {
  RunControl cancelled, expired;
  cancelled.cancel();
  expired.expire();
  for (const auto& work : {std::function<void(RunControl&)>([](RunControl& c) { c.check(); }),
                           std::function<void(RunControl&)>([](RunControl& c) { c.check_and_move(); }),
                           std::function<void(RunControl&)>([](RunControl& c) { c.check_comparison(); }),
                           std::function<void(RunControl&)>([](RunControl& c) { c.enter(Stage::kVerify); }),
                           std::function<void(RunControl&)>([](RunControl& c) { c.progress(1); })}) {
    EXPECT_EQ(code_of([&] { work(cancelled); }), Code::kCancelled);
    EXPECT_EQ(code_of([&] { work(expired); }), Code::kTimeout);
  }
}

TEST(run_control, the_first_reason_wins) {
  RunControl control;
  control.expire();
  control.cancel();
  EXPECT_TRUE(control.is_stopped());
  EXPECT_EQ(code_of([&] { control.check(); }), Code::kTimeout);
}

TEST(run_control, progress_moves_at_each_check_of_work_that_checks_seldom) {
  RunControl control;
  control.enter(Stage::kWeld);
  for (int i = 0; i < 1000; ++i) {
    const double before = control.fraction();
    control.check_and_move();
    EXPECT_GT(control.fraction(), before);
  }
  EXPECT_LT(control.fraction(), 0.1);
}

TEST(run_control, a_million_comparisons_leave_nearly_all_of_the_progress) {
  RunControl control;
  control.enter(Stage::kWeld);
  for (int i = 0; i < 1'000'000; ++i) control.check_comparison();
  EXPECT_GT(control.fraction(), 0);
  EXPECT_LT(control.fraction(), 0.01);
}

TEST(run_control, a_new_stage_starts_at_no_progress) {
  RunControl control;
  EXPECT_EQ(control.stage(), Stage::kQueued);
  control.enter(Stage::kWeld);
  control.progress(0.25);
  EXPECT_EQ(control.stage(), Stage::kWeld);
  // Entering the stage and telling the progress are checks, too, and may move it a little.
  EXPECT_NEAR(control.fraction(), 0.25, 1e-4);
  control.enter(Stage::kLoops);
  EXPECT_EQ(control.stage(), Stage::kLoops);
  EXPECT_EQ(control.fraction(), 0);
}

TEST(run_control, progress_moves_with_work_that_nobody_counts) {
  RunControl control;
  control.enter(Stage::kVerify);
  control.progress(0.5);
  double last = control.fraction();
  for (int moves = 0; moves < 100; ++moves) {
    for (int checks = 0; checks < 1 << 10; ++checks) control.check();
    EXPECT_GT(control.fraction(), last);
    last = control.fraction();
  }
  EXPECT_LT(last, 0.55);
  EXPECT_NEAR(control.told_fraction(), 0.5, 1e-6);
  control.progress(0.6);
  EXPECT_GT(control.fraction(), last);
  control.enter(Stage::kQuality);
  EXPECT_EQ(control.fraction(), 0);
}

TEST(run_control, another_thread_can_stop_the_work) {
  RunControl control;
  std::thread watcher([&] { control.cancel(); });
  const Code code = code_of([&] {
    while (true) control.check();
  });
  watcher.join();
  EXPECT_EQ(code, Code::kCancelled);
}

}  // namespace
}  // namespace remesh
