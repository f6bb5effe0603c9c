// Tests inputs that would take long without a bound on the work of each stage. The answer is verified, tells what was
// given up, and is the same for any number of workers.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/work_bound.h"
#include "core/io/obj/obj.h"
#include "core/refinement/attempts/surface_refinement.h"
#include "core/refinement/sizes/gap_search.h"
#include "tests/support/errors.h"
#include "tests/support/hostile_families.h"
#include "tests/support/random.h"
#include "tests/support/refined_checks.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/time_limit.h"

namespace remesh {
namespace {

/// Makes n squares with one edge in common, like the pages of an open book.
PolygonMesh pages(std::uint32_t n) {
  std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 1}};
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    positions.push_back({std::cos(angle), std::sin(angle), 0});
    positions.push_back({std::cos(angle), std::sin(angle), 1});
    faces.push_back({0, 2 * i + 2, 2 * i + 3, 1});
  }
  return shapes::from_lists(positions, faces);
}

/// Makes a box in which two neighbouring walls are nearly one plane with a third that cuts through it, so that gaps
/// close towards long edges.
PolygonMesh wedges(double width) {
  const PolygonMesh wedge = shapes::prism({{0, 0}, {1, 0}, {1, width}}, 1);
  return shapes::joined(wedge, shapes::moved(shapes::rotated(wedge, {1, 2, 3}, 70), {0.3, 0.2, 0.1}));
}

std::string mesh_and_list(const Result& result) {
  RunControl control;
  return write_obj(result.mesh, {}, control) + listed_in_words(result.report);
}

void expect_bounded(const PolygonMesh& mesh, const Options& options) {
  const Result result = refined(mesh, options, 1);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LE(result.mesh.faces.size(), options.max_output_faces.value());
  // The measurement does not trust the report.
  EXPECT_LE(faces_beyond(result.mesh, bounds_of(options), 1e-9).size(), listed(result.report));
  const std::string one = mesh_and_list(result);
  for (const int workers : {2, 8})
    EXPECT_TRUE(one == mesh_and_list(refined(mesh, options, workers))) << workers << " workers";
}

Options with_gaps(std::uint64_t max_faces) {
  Options options;
  options.proximity = 1;
  options.min_angle_deg = 20;
  options.max_output_faces = max_faces;
  return options;
}

TEST(work_bound, counts_steps_until_the_bound_is_spent) {
  WorkBound bound(10);
  bound.take(4);
  EXPECT_EQ(bound.left(), 6u);
  EXPECT_FALSE(bound.is_spent());
  bound.take(WorkBound::kNone);
  EXPECT_EQ(bound.left(), 0u);
  EXPECT_TRUE(bound.is_spent());
  WorkBound none;
  none.take(WorkBound::kNone - 1);
  EXPECT_FALSE(none.is_spent());
}

TEST(work_bound, work_without_a_bound_never_runs_out) {
  WorkBound work;
  work.take(1000);
  EXPECT_EQ(work.taken(), 1000u);
  EXPECT_EQ(work.left(), WorkBound::kNone);
  EXPECT_FALSE(work.is_spent());
}

TEST(work_bound, a_stage_has_steps_for_each_face_times_the_logarithm) {
  const StageWork work{3, 5, 100};
  // 8 + 8 faces have a logarithm of 5 binary digits.
  EXPECT_EQ(work.steps(8, 8), 100u + 5 * (3 * 8 + 5 * 8));
  EXPECT_EQ(work.steps(0, 0), 100u);
  EXPECT_EQ((StageWork{3, 5, 100, StageWork::Growth::kLinear}.steps(8, 8)), 100u + 3 * 8 + 5 * 8);
  EXPECT_EQ(work.steps(8, WorkBound::kNone), WorkBound::kNone);
}

TEST(effort, many_pages_of_one_edge_are_refined_within_the_limit) { expect_bounded(pages(300), with_gaps(3000)); }

TEST(effort, many_sharp_edges_are_refined_within_the_limit) { expect_bounded(wedges(0.01), with_gaps(3000)); }

// Faces that need a long search for the gaps beside them are not looked at behind the bound. Needles that could not be
// refined as asked stay as they were, so these two occur together.
TEST(effort, needles_of_which_many_are_not_looked_at_end_at_the_limit) {
  const auto families = hostile::families();
  const auto needles = std::find_if(families.begin(), families.end(),
                                    [](const hostile::Family& family) { return family.name == "spanning_needles"; });
  ASSERT_NE(needles, families.end());
  Options options = with_gaps(4000);
  options.min_angle_deg = 0;
  expect_bounded(needles->make(500), options);
}

TEST(effort, a_search_for_gaps_never_answers_less_when_its_work_is_bounded) {
  const StageChain chain(pages(40));
  const GapSearch gaps(chain.surface, chain.adjacency, chain.patches, 1e-6, chain.control);
  Random random(40);
  int cut_short = 0;
  for (int i = 0; i < 200; ++i) {
    const PatchId p(static_cast<std::size_t>(random.below(40)));
    const Triangle& t = gaps.triangles_of(p)[0];
    const auto& at = chain.surface.positions;
    const double u = random.unit(), v = random.unit() * (1 - u);
    const Vec3 place = at[t[0]] + u * (at[t[1]] - at[t[0]]) + v * (at[t[2]] - at[t[0]]);
    const double all = gaps.at(place, p, HUGE_VAL);
    const auto max = static_cast<std::uint64_t>(1 + random.below(60));
    WorkBound none, few(max);
    EXPECT_EQ(gaps.at(place, p, HUGE_VAL, nullptr, &none), all);
    EXPECT_GE(gaps.at(place, p, HUGE_VAL, nullptr, &few), all);
    EXPECT_EQ(few.is_spent(), none.taken() >= max);
    cut_short += few.is_spent() ? 1 : 0;
  }
  EXPECT_GT(cut_short, 20);
}

TEST(effort, when_attempts_have_taken_all_the_work_nothing_is_refined_and_all_is_listed) {
  StageChain chain(shapes::box({1, 1, 1}));
  Options options;
  options.max_edge_length = 0.2;
  options.max_output_faces = 4000;
  const Goals goals = goals_of(options, std::sqrt(3));
  const std::size_t before = chain.meshes[PatchId(0)].mesh.triangle_count();
  const PatchedSurface on{chain.surface, chain.adjacency, chain.patches, 1e-6};
  const Effort spent{.triangles = kWorkOfAttempts.steps(0, goals.max_faces)};
  RefinementChoices choices{MinEdgeSearch(goals)};
  choices.budget = first_budget(goals.max_faces);
  const Refinement refinement =
      SurfaceRefinement(goals, {}, chain.control)
          .refine(on, choices, spent, IdVector<PatchId, std::uint8_t>(chain.patches.count(), 0), chain.triangulated)
          .refinement;
  EXPECT_EQ(chain.meshes[PatchId(0)].mesh.triangle_count(), before);
  ASSERT_EQ(refinement.reason.size(), 12u);
  for (const UnrefinedReason reason : refinement.reason) EXPECT_EQ(reason, UnrefinedReason::kEffort);
}

TEST(effort, where_gaps_ask_for_far_more_than_is_allowed_sizes_are_as_coarse_as_the_limit) {
  // Two plates that ask for more than a million faces, and a bar far from them, of which no gap asks for anything.
  const PolygonMesh plate = shapes::sheet(1, 1, 1, 1);
  const PolygonMesh plates = shapes::joined(plate, shapes::moved(plate, {0, 0, 0.002}));
  const PolygonMesh mesh = shapes::joined(plates, shapes::moved(shapes::box({1, 0.1, 0.1}), {0, 5, 0}));
  Options options;
  options.proximity = 1;
  options.max_output_faces = 5000;
  const Result result = refined(mesh, options);
  expect_promises(mesh, options, result);
  EXPECT_LE(result.mesh.faces.size(), 5000u);
  EXPECT_GT(result.mesh.faces.size(), 1000u);
  // Nearly all faces of the plates are longer than the gap. All of these are listed.
  std::size_t too_long = 0;
  for (const auto& [a, b, c] : result.mesh.faces) {
    const Vec3 &p = result.mesh.positions[a], &q = result.mesh.positions[b], &r = result.mesh.positions[c];
    const double longest = std::max({norm(q - p), norm(r - q), norm(p - r)});
    too_long += p.y <= 1 && longest > 0.002 * Goals::kSizeSlack ? 1 : 0;
  }
  EXPECT_GT(too_long, 500u);
  EXPECT_GE(listed(result.report), too_long) << listed_in_words(result.report);
}

// With coordinates this large the areas of all triangles are 0, and no size can be found from that.
TEST(effort, an_area_that_is_lost_beside_a_long_face_does_not_repeat_attempts_for_ever) {
  const PolygonMesh square =
      shapes::from_lists({{-.5, -5e149, -.5}, {.5, -5e149, -.5}, {.5, 5e149, -.5}, {-.5, 5e149, -.5}}, {{0, 1, 2, 3}});
  PolygonMesh mesh = shapes::rotated(square, {1, 0, 1}, 40);
  for (int i = 0; i < 10; ++i) mesh = shapes::joined(shapes::moved(shapes::box({1, 1, .01}), {1.5 * i, 0, 0}), mesh);
  EXPECT_EQ(test::error_of([&] { refined(mesh, with_gaps(99), 1); }).code, Code::kOutputTooLarge);
}

TEST(effort, when_half_of_the_work_was_in_vain_patches_that_have_not_failed_are_refined_last) {
  StageChain chain(shapes::box({1, 1, 1}));
  Options options;
  options.max_edge_length = 0.2;
  options.max_output_faces = 4000;
  const Goals goals = goals_of(options, std::sqrt(3));
  const PatchedSurface on{chain.surface, chain.adjacency, chain.patches, 1e-6};
  const Effort nearly{.triangles = kWorkOfAttempts.steps(0, goals.max_faces) - 1100, .wrong = 1};
  EXPECT_TRUE(nearly.is_in_vain(goals.max_faces)) << "so an attempt is to show whether a result passes at all";
  // The attempt after that leaves out what has failed. It makes no more faces than half of the work that is left
  // allows.
  RefinementChoices choices{MinEdgeSearch(goals)};
  choices.part = RefinedPart::kRest;
  choices.budget = first_budget(goals.max_faces);
  const PatchId failed(0);
  IdVector<PatchId, std::uint8_t> frozen(chain.patches.count(), 0);
  frozen[failed] = 1;
  const std::size_t before = chain.meshes[failed].mesh.triangle_count();
  const Refinement little =
      SurfaceRefinement(goals, {}, chain.control).refine(on, choices, nearly, frozen, chain.triangulated).refinement;
  EXPECT_EQ(chain.meshes[failed].mesh.triangle_count(), before);
  EXPECT_GT(little.reason.size(), 100u);
  EXPECT_LE(little.reason.size(), 1100u / 2);
}

// Each of very many patches makes few triangles in a round. Together they make millions if they are counted only when
// the round is over. It takes a second on an idle machine, and took twenty when they were.
TEST(effort, an_attempt_with_far_too_many_triangles_ends_within_a_round_of_small_patches) {
  PolygonMesh sphere = shapes::sphere(5);
  for (Vec3& p : sphere.positions) p.z *= 1e4;
  // By default, the cones of this sphere are joined first, and attempts at them take longer than this bound.
  Options options;
  options.coarsens_fine_facets = false;
  const test::Seconds before = test::processor_time();
  const Result result = remeshed(sphere, options);
  test::expect_within(test::Seconds(5), test::processor_time() - before);
  EXPECT_LE(result.mesh.faces.size(), 20 * sphere.face_count() + 1000);
}

TEST(effort, long_walks_through_needles_are_bounded) {
  // Each face is a needle of 8e7 by 6, on which some points of a lattice of 0.5 find room. It takes two seconds on an
  // idle machine, and took twenty when only cavities counted as work.
  const double far = 8e7, near = 3;
  const PolygonMesh spindle =
      shapes::from_lists({{-near, 0, 0}, {near, 0, 0}, {far, -near, 0}, {0, near, 0}, {0, 0, near}, {0, 0, -near}},
                         {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
  Options options;
  options.max_edge_length = 0.5;
  options.max_output_faces = 200'000;
  const test::Seconds before = test::processor_time();
  EXPECT_TRUE(refined(spindle, options, 1).report.verified.all_true());
  test::expect_within(test::Seconds(10), test::processor_time() - before);
}

}  // namespace
}  // namespace remesh
