#include "api/overall_progress.h"

#include <gtest/gtest.h>

namespace remesh::api {
namespace {

TEST(overall_progress, it_goes_from_0_to_1_through_all_stages) {
  OverallProgress progress;
  EXPECT_EQ(progress.look(Stage::kQueued, 0), 0);
  EXPECT_EQ(progress.look(Stage::kRead, 0), 0);
  double last = 0;
  for (int s = static_cast<int>(Stage::kRead); s < kStageCount; ++s)
    for (const double fraction : {0.25, 0.5, 1.0}) {
      const double now = progress.look(static_cast<Stage>(s), fraction);
      EXPECT_GT(now, last) << s;
      last = now;
    }
  EXPECT_EQ(last, 1);
}

TEST(overall_progress, it_never_goes_back_whatever_a_run_does) {
  OverallProgress progress;
  double last = 0;
  for (int attempt = 0; attempt < 5; ++attempt)
    for (const Stage stage : {Stage::kRead, Stage::kTriangulation, Stage::kSurfaces, Stage::kRefinement,
                              Stage::kAssembly, Stage::kVerify, Stage::kQuality, Stage::kAssembly, Stage::kWrite})
      for (const double fraction : {0.0, 0.9, 0.2, 1.0, 0.0}) {
        const double now = progress.look(stage, fraction);
        EXPECT_GE(now, last);
        EXPECT_LE(now, 1);
        last = now;
      }
}

TEST(overall_progress, a_search_in_the_input_is_not_the_check_of_a_result) {
  OverallProgress progress, usual;
  progress.look(Stage::kTriangulation, 1);
  EXPECT_LT(progress.look(Stage::kVerify, 0.9), 0.2);
  EXPECT_EQ(progress.look(Stage::kRefinement, 0.5), usual.look(Stage::kRefinement, 0.5));
  EXPECT_GT(progress.look(Stage::kVerify, 0.9), 0.8);
}

TEST(overall_progress, another_attempt_has_what_is_left) {
  OverallProgress progress, usual;
  progress.look(Stage::kAssembly, 0);
  const double before = progress.look(Stage::kVerify, 1);
  EXPECT_EQ(progress.look(Stage::kRefinement, 0), before);
  // The end of refinement is as far in what is left as in a run that begins with refinement.
  const double from = usual.look(Stage::kRefinement, 0), to = usual.look(Stage::kRefinement, 1);
  EXPECT_NEAR(progress.look(Stage::kRefinement, 1), before + (1 - before) * (to - from) / (1 - from), 1e-12);
  EXPECT_LT(progress.look(Stage::kVerify, 1), 1);
}

TEST(overall_progress, the_time_that_is_left_follows_from_the_time_that_was_taken) {
  EXPECT_EQ(seconds_left(0.05, 10), std::nullopt);
  EXPECT_EQ(seconds_left(0.5, 0.5), std::nullopt);
  EXPECT_DOUBLE_EQ(*seconds_left(0.25, 5), 15);
  EXPECT_EQ(seconds_left(1, 5), 0);
}

}  // namespace
}  // namespace remesh::api
