#include "core/refinement/refiner/patch_refiner.h"

#include <gtest/gtest.h>

#include "tests/support/invariance.h"

namespace remesh {
namespace {

TEST(refinement_progress, it_is_the_part_of_the_expected_triangles_and_never_goes_back) {
  RunControl control;
  RefinementProgress progress(control, 200);
  progress.begin(50);
  progress.add(50);
  EXPECT_DOUBLE_EQ(control.fraction(), 0.5);
  progress.add(-20);
  EXPECT_DOUBLE_EQ(control.fraction(), 0.5);
  progress.begin(10);
  progress.add(10);
  EXPECT_DOUBLE_EQ(control.fraction(), 0.5);
  progress.add(140);
  EXPECT_DOUBLE_EQ(control.fraction(), 0.8);
  progress.add(1000);
  EXPECT_DOUBLE_EQ(control.told_fraction(), 0.95);
}

TEST(refinement_progress, nothing_expected_is_no_error) {
  RunControl control;
  RefinementProgress progress(control, 0);
  progress.add(0);
  EXPECT_DOUBLE_EQ(control.fraction(), 0);
}

STAGE(refinement_progress, test::kStop) { RefinementProgress(trial.control, 10).add(1); }

}  // namespace
}  // namespace remesh
