// Tests the largest number of faces that is allowed. There are never more. If they are needed, there are nearly as
// many. If they are not, the limit does not make the mesh worse.

#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <utility>

#include "core/base/error.h"
#include "core/remesh.h"
#include "tests/support/invariance.h"
#include "tests/support/polygons.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/time_limit.h"

namespace remesh {
namespace {

TEST(refinement_budget, a_budget_is_never_exceeded_and_what_it_leaves_is_listed) {
  const PolygonMesh mesh = solids::extrusion(polygons::star_with_holes(11, 40, 3), 0.4);
  const Options unlimited = with_angle(30);
  const std::uint64_t all = refined(mesh, unlimited).mesh.faces.size();
  const std::uint64_t least = refined(mesh, with_angle(0)).mesh.faces.size();
  ASSERT_GT(all, least + 100);
  for (const std::uint64_t budget : {least, least + 1, least + 50, (least + all) / 2, all - 1}) {
    Options options = unlimited;
    options.max_output_faces = budget;
    const Result result = refined(mesh, options);
    expect_promises(mesh, options, result);
    EXPECT_LE(result.mesh.faces.size(), budget);
    EXPECT_GT(listed(result.report, UnrefinedReason::kBudget), 0u);
  }
}

void expect_budgets_nearly_used_up(const PolygonMesh& mesh, Options options, std::initializer_list<double> shares,
                                   double at_least = 0.5) {
  const auto all = static_cast<double>(refined(mesh, options).mesh.faces.size());
  for (const double share : shares) {
    options.max_output_faces = static_cast<std::uint64_t>(share * all);
    const Result result = refined(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_LE(result.mesh.faces.size(), *options.max_output_faces);
    EXPECT_GT(static_cast<double>(result.mesh.faces.size()), at_least * share * all) << share;
  }
}

TEST(refinement_budget, a_budget_is_nearly_used_up) {
  expect_budgets_nearly_used_up(shapes::box({100, 1, 1}), with_angle(30), {0.3, 0.6, 0.9});
}

TEST(refinement_budget, a_budget_is_nearly_used_up_where_sheets_are_in_one_place) {
  Options options = with_angle(30);
  options.min_edge_length = 0;
  expect_budgets_nearly_used_up(solids::stacked_boxes(20, 50), options, {0.1, 0.3, 0.6, 0.9});
}

TEST(refinement_budget, a_budget_is_nearly_used_up_where_many_patches_cut_what_they_share) {
  // A cylinder that stands over a block: its facets are strips, and all of them are cut near the gap.
  const PolygonMesh mesh =
      shapes::joined(shapes::cylinder(48, 10, 60), shapes::moved(shapes::box({24, 24, 41.2}), {-12, -12, -43}));
  Options options;
  options.proximity = 1;
  expect_budgets_nearly_used_up(mesh, options, {0.55, 0.7, 0.8, 0.9}, 0.93);
}

TEST(refinement_budget, a_budget_of_twice_what_is_needed_changes_little_where_one_patch_needs_most) {
  PolygonMesh mesh = shapes::box({40, 40, 1});
  for (int i = 0; i < 40; ++i) mesh = shapes::joined(mesh, shapes::moved(shapes::box({1, 1, 1}), {2.0 * i, 50, 0}));
  Options options;
  options.max_edge_length = 1;
  const std::size_t all = refined(mesh, options).mesh.faces.size();
  options.max_output_faces = 2 * all;
  EXPECT_NEAR(static_cast<double>(refined(mesh, options).mesh.faces.size()) / static_cast<double>(all), 1, 0.01);
}

/// Makes a block with a slot. Behind the slot sizes grow. With a bound of 33 degrees there are three times as many
/// triangles before they are thinned out.
PolygonMesh slotted_block() {
  return shapes::prism({{0, 0}, {4, 0}, {4, 1.95}, {1, 1.95}, {1, 2.05}, {4, 2.05}, {4, 4}, {0, 4}}, 2);
}

/// Makes options for the block, without a floor that keeps the result in proportion.
Options options_of_slot() {
  Options options = with_angle(33);
  options.proximity = 2;
  options.min_edge_length = 0;
  return options;
}

TEST(refinement_budget, what_is_made_in_between_and_thinned_out_is_no_reason_to_leave_anything_undone) {
  Options options = options_of_slot();
  const Result all = refined(slotted_block(), options);
  for (const double share : {1.0, 1.7, 2.0, 2.6, 100.0}) {
    options.max_output_faces = static_cast<std::uint64_t>(share * static_cast<double>(all.mesh.faces.size()));
    const Result result = refined(slotted_block(), options);
    EXPECT_EQ(result.mesh.positions, all.mesh.positions) << share;
    EXPECT_EQ(result.mesh.faces, all.mesh.faces) << share;
    EXPECT_EQ(listed(result.report, UnrefinedReason::kBudget), 0u) << share;
  }
}

TEST(refinement_budget, what_thinning_out_leaves_room_for_is_used) {
  Options options = options_of_slot();
  const std::uint64_t all = refined(slotted_block(), options).mesh.faces.size();
  options.max_output_faces = all - all / 8;
  const Result result = refined(slotted_block(), options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LE(result.mesh.faces.size(), *options.max_output_faces);
  EXPECT_GT(result.mesh.faces.size(), *options.max_output_faces * 97 / 100);
  // An eighth less faces, and the budget is named for few. The share is pinned from a run and may change with the
  // algorithm.
  constexpr std::uint64_t kPinnedPart = 45;
  EXPECT_LT(listed(result.report, UnrefinedReason::kBudget), all / kPinnedPart);
}

STAGE(refinement_without_a_budget, test::kWorkers) {
  Options options = options_of_slot();
  options.max_output_faces = 12'000;
  const Result result = refined(slotted_block(), options, trial.workers);
  EXPECT_LE(result.mesh.faces.size(), 12'000u);
  trial.mesh(result.mesh);
}

TEST(refinement_budget, a_budget_is_spent_to_the_end_where_patches_are_many_and_small) {
  PolygonMesh mesh;
  for (int i = 0; i < 40; ++i) {
    const PolygonMesh box = shapes::moved(shapes::box({1, 0.15, 1}), {0, 1.0 * i, 0});
    mesh = i == 0 ? box : shapes::joined(mesh, box);
  }
  Options options = with_angle(25);
  expect_budgets_nearly_used_up(mesh, options, {0.5, 0.7, 0.9});
  const std::uint64_t all = refined(mesh, options).mesh.faces.size();
  for (const std::uint64_t budget : {all + all / 4, 2 * all, 3 * all}) {
    options.max_output_faces = budget;
    const Result result = refined(mesh, options);
    EXPECT_EQ(result.mesh.faces.size(), all) << budget;
    EXPECT_EQ(listed(result.report), 0u) << budget;
  }
}

TEST(refinement_budget, a_budget_is_nearly_used_up_though_cuts_for_sizes_alone_take_more) {
  // Thin sticks: most of their faces are for cuts.
  const PolygonMesh stick = shapes::box({2, 0.02, 0.02});
  const PolygonMesh sticks = shapes::joined(stick, shapes::moved(stick, {0, 0.1, 0.3}));
  Options options = with_angle(0);
  options.proximity = 1;
  expect_budgets_nearly_used_up(sticks, options, {0.15, 0.3, 0.6});
}

TEST(refinement_budget, a_limit_of_what_comes_out_without_one_is_never_refused_whatever_keeps_sizes_from_being_met) {
  Options locked = with_length(0.05), narrow = with_length(0.5), few;
  locked.split_boundaries = false;
  narrow.min_edge_length = 0.2;
  few.max_area = 1e-3;
  few.min_edge_length = 0.2;
  const PolygonMesh needle = shapes::triangle(10, 4, 4);
  for (const auto& [mesh, asked] : {std::pair(shapes::box({1, 1, 1}), locked), std::pair(shapes::box({1, 1, 1}), few),
                                    std::pair(needle, locked), std::pair(needle, narrow), std::pair(needle, few)}) {
    const std::uint64_t all = refined(mesh, asked).mesh.faces.size();
    Options options = asked;
    options.max_output_faces = all;
    try {
      EXPECT_LE(refined(mesh, options).mesh.faces.size(), all);
    } catch (const Error& error) {
      ADD_FAILURE() << all << " faces: " << error.what();
    }
  }
}

TEST(refinement_budget, a_result_that_must_be_larger_than_allowed_is_refused_at_once) {
  for (const double length : {0.01, 1e-4, 1e-7, 1e-12, 1e-300}) {
    Options options = with_length(length);
    options.max_output_faces = 10'000;
    RunControl control;
    // A refusal takes less than a millisecond. Computing the smallest of these results takes longer than a second.
    test::expect_within(test::Seconds(1), [&] {
      try {
        remesh_surface(shapes::box({1, 1, 1}), options, {}, control);
        ADD_FAILURE() << length << " was not refused";
      } catch (const Error& error) {
        EXPECT_EQ(code_name(error.code), code_name(Code::kOutputTooLarge)) << length;
        EXPECT_EQ(error.limit, 10'000u);
      }
    });
  }
}

TEST(refinement_budget, segments_that_would_have_far_too_many_pieces_are_cut_less_often) {
  // Coordinates are so large beside the small sides of this octahedron that rounding leaves no room for most cuts, so
  // the request cannot be refused. All cuts together would take gigabytes.
  constexpr double kFar = 6e7, kRadius = 3.3;
  const std::vector<Vec3> positions{{-2e7 + kRadius, -kFar, kFar}, {-2e7 - kRadius, -kFar, kFar},
                                    {kFar, -kFar - kRadius, kFar}, {-2e7, -kFar + kRadius, kFar},
                                    {-2e7, -kFar, kFar + kRadius}, {-2e7, -kFar, kFar - kRadius}};
  const PolygonMesh mesh = shapes::from_lists(
      positions, {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
  for (const double length : {0.5, 5.0}) {
    Options options = with_length(length);
    options.max_output_faces = 6000;
    const Result result = refined(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_LE(result.mesh.faces.size(), 6000u);
  }
}

}  // namespace
}  // namespace remesh
