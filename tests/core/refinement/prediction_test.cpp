#include "core/refinement/prediction/prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// Returns the lower bound on the number of faces.
/// Input:  `frozen` is a patch that stays as it is, if it is valid.
double least(const PolygonMesh& mesh, const Options& options, PatchId frozen = {}) {
  StageChain chain(mesh);
  const Goals goals = goals_of(options, 1);
  const SizeField sizes(goals.max_edge_length);
  IdVector<PatchId, std::uint8_t> is_frozen(chain.meshes.size());
  if (frozen.is_valid()) is_frozen[frozen] = 1;
  const SegmentTable segments(chain.surface, chain.triangulated, is_frozen, sizes, goals, chain.control);
  return least_faces(chain.triangulated, is_frozen, segments, goals, sizes, chain.control);
}

TEST(prediction, the_least_is_the_area_over_that_of_the_largest_triangles) {
  EXPECT_NEAR(least(shapes::box({1, 1, 1}), with_length(0.01)), 6 / (std::sqrt(3) / 4 * 1e-4), 1e-6);
  Options by_area;
  by_area.max_area = 1e-3;
  EXPECT_NEAR(least(shapes::box({1, 1, 1}), by_area), 6000, 1e-6);
}

TEST(prediction, the_least_is_a_triangle_for_each_piece_of_the_boundary_of_what_is_narrow) {
  EXPECT_EQ(least(shapes::polygon({{0, 0}, {10, 0}, {10, 0.01}, {0, 0.01}}), with_length(0.1)), 200);
}

TEST(prediction, what_stays_as_it_is_has_no_more_than_its_triangles) {
  Options options = with_length(0.01);
  options.split_boundaries = false;
  EXPECT_EQ(least(shapes::box({1, 1, 1}), options), 12);
  // All faces but one have a side along the frozen one.
  const double of_face = 1 / (std::sqrt(3) / 4 * 1e-4), of_boundary = 3 * 100 + 1 - 2;
  EXPECT_NEAR(least(shapes::box({1, 1, 1}), with_length(0.01), PatchId(0)), 2 + of_face + 4 * of_boundary, 1e-6);
}

TEST(prediction, sizes_near_the_shortest_edge_ask_for_nothing) {
  Options options = with_length(0.01);
  options.min_edge_length = 1e-4;
  EXPECT_GT(least(shapes::box({1, 1, 1}), options), 100'000);
  options.min_edge_length = 1e-3;
  EXPECT_EQ(least(shapes::box({1, 1, 1}), options), 12);
}

TEST(prediction, sizes_without_measure_count_though_rounding_leaves_some_triangles_larger) {
  // As long as that, its sides can be cut into pieces of a unit at least.
  const double length = 1e9;
  Options by_area;
  by_area.max_area = 0.5;
  EXPECT_GT(least(shapes::polygon({{0, 0}, {length, 0}, {length, 1}, {0, 1}}), by_area), 5e7);
  // So thin that no side can be cut; but far from them there is room on the large faces.
  by_area.max_area = 1e-16;
  const double of_plate = least(shapes::box({1, 1, 1e-9}), by_area);
  EXPECT_GT(of_plate, 1e6);
  EXPECT_LT(of_plate, 2.1 / 1e-16);
}

TEST(prediction, what_is_asked_for_beside_locked_sides_of_a_strip_counts_for_nothing) {
  // All of it is nearer to the long sides than these are long.
  Options options = with_length(1e-6);
  options.split_boundaries = false;
  EXPECT_EQ(least(shapes::polygon({{0, 0}, {10, 0}, {10, 0.1}, {0, 0.1}}), options), 2);
}

}  // namespace
}  // namespace remesh
