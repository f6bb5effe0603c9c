#include <gtest/gtest.h>

#include <cmath>

#include "core/refinement/prediction.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

Prediction predicted(const PolygonMesh& mesh, const Options& options) {
  StageChain chain(mesh);
  const Goals goals = goals_of(options, 1);
  return predict_closely(chain.triangulated, goals, SizeField(goals.max_edge_length), chain.control);
}

TEST(close_prediction, a_needle_whose_only_small_angle_is_that_of_the_input_is_one_face) {
  EXPECT_EQ(predicted(shapes::polygon({{0, -0.1}, {10, 0}, {0, 0.1}}), with_angle(25)).expected, 1);
}

TEST(close_prediction, a_strip_has_a_face_for_each_piece_of_its_sides) {
  // Pieces are twice the width over the tangent of 30 degrees. Its short sides have a face each.
  const double pieces = 10 / (2 * 0.1 / std::tan(std::acos(-1) / 6));
  const double faces = predicted(shapes::polygon({{0, 0}, {10, 0}, {10, 0.1}, {0, 0.1}}), with_angle(25)).expected;
  EXPECT_NEAR(faces / (2 * pieces + 2), 1, 0.25);
}

TEST(close_prediction, the_faces_beside_a_strip_share_its_cuts) {
  const double strip = predicted(shapes::polygon({{0, 0}, {10, 0}, {10, 0.1}, {0, 0.1}}), with_angle(25)).expected;
  const Prediction plate = predicted(shapes::box({10, 10, 0.1}), with_angle(25));
  // Four strips; and both large faces have a face at least for each piece of their four sides.
  EXPECT_GT(plate.expected, 4 * strip + 4 * strip);
  double sum = 0;
  for (const float share : plate.of_patch) {
    EXPECT_GE(share, 1);
    sum += share;
  }
  EXPECT_NEAR(sum / plate.expected, 1, 1e-6);
}

TEST(close_prediction, floors_lower_it_until_nothing_can_be_cut) {
  Options options = with_angle(25);
  double last = predicted(shapes::box({10, 10, 0.01}), options).expected;
  EXPECT_GT(last, 1000);
  // Each floor is above a length of pieces without one, which is 0.035. The last one is above the thickness alone.
  options.min_edge_length = 0.02;
  EXPECT_EQ(predicted(shapes::box({10, 10, 0.01}), options).expected, 12);
  for (const double floor : {0.1, 0.2, 0.4}) {
    options.min_edge_length = floor;
    const double faces = predicted(shapes::polygon({{0, 0}, {10, 0}, {10, 10}, {0.5, 10}, {0, 0.5}}), options).expected;
    EXPECT_LE(faces, last);
    last = faces;
  }
}

TEST(close_prediction, without_an_angle_or_cuts_of_boundaries_it_is_the_rough_one) {
  Options by_size = with_length(0.1), locked = with_angle(25);
  by_size.min_angle_deg = 0;
  locked.split_boundaries = false;
  for (const Options& options : {by_size, locked}) {
    StageChain chain(shapes::box({3, 2, 1}));
    const Goals goals = goals_of(options, 1);
    const SizeField sizes(goals.max_edge_length);
    EXPECT_EQ(predict_closely(chain.triangulated, goals, sizes, chain.control).expected,
              predict_roughly(chain.triangulated, goals, sizes, chain.control).expected);
  }
}

TEST(close_prediction, it_scales_with_the_input) {
  const Prediction one = predicted(shapes::box({10, 4, 0.1}), with_angle(25));
  const Prediction large = predicted(shapes::box({10 * 0x1p10, 4 * 0x1p10, 0.1 * 0x1p10}), with_angle(25));
  EXPECT_NEAR(large.expected / one.expected, 1, 1e-9);
}

}  // namespace
}  // namespace remesh
