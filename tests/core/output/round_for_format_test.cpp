// Tests results in the numbers of binary STL. A result is right by geometry, or it is refused with the reason.
#include "core/output/result/round_for_format.h"
#include "core/remesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/rounded_to_float.h"
#include "tests/support/errors.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using testing::HasSubstr;
using testing::Not;

Result in_floats(const PolygonMesh& mesh, Options options = unrefined(), int workers = 1) {
  RunControl control;
  return remesh_surface(mesh, options, {.workers = workers, .storage = Storage::kFloat}, control);
}
Result in_doubles(const PolygonMesh& mesh, const Options& options = unrefined()) {
  RunControl control;
  return remesh_surface(mesh, options, {}, control);
}

bool are_floats(const Result& result) {
  return std::all_of(result.mesh.positions.begin(), result.mesh.positions.end(),
                     [](const Vec3& p) { return p == rounded_to_float(p); });
}

double largest_difference(const Result& a, const Result& b, const Vec3& origin = {}) {
  double largest = 0;
  for (std::uint32_t v = 0; v < a.mesh.positions.size(); ++v)
    largest = std::max(largest, norm(a.mesh.positions[VertexId(v)] + origin - b.mesh.positions[VertexId(v)]));
  return largest;
}

PolygonMesh at_map_coordinates(double size) {
  return shapes::moved(shapes::scaled(shapes::rotated(shapes::l_bracket(2), {0, 0, 1}, 30), size), {5e5, 5e6, 100});
}

TEST(round_for_format, the_report_is_about_the_rounded_mesh) {
  const PolygonMesh turned = shapes::rotated(shapes::l_bracket(2), {1, 2, 3}, 40);
  const Result exact = in_doubles(turned), rounded = in_floats(turned);
  EXPECT_TRUE(are_floats(rounded));
  EXPECT_FALSE(are_floats(exact));
  EXPECT_EQ(exact.report.output_rounding, 0);
  EXPECT_DOUBLE_EQ(rounded.report.output_rounding, largest_difference(rounded, exact));
  EXPECT_GT(rounded.report.output_rounding, 0);
  EXPECT_FALSE(rounded.report.output_origin);
  EXPECT_DOUBLE_EQ(rounded.report.verified.deviation, exact.report.verified.deviation + rounded.report.output_rounding);
  EXPECT_LE(std::fabs(*rounded.report.output.volume - *exact.report.output.volume), rounded.report.volume_bound);
  EXPECT_GT(rounded.report.volume_bound, exact.report.volume_bound);
  EXPECT_NE(rounded.report.output.quality.min_angle_deg, exact.report.output.quality.min_angle_deg);
  for (std::size_t p = 0; p < exact.report.patches.size(); ++p)
    EXPECT_GT(rounded.report.patches[p].deviation, exact.report.patches[p].deviation);
  EXPECT_TRUE(rounded.report.volume_obstacles.empty());
  EXPECT_EQ(rounded.face_patch, exact.face_patch);
}

TEST(round_for_format, what_floats_hold_is_the_same_in_both) {
  const Result exact = in_doubles(shapes::l_bracket(2)), rounded = in_floats(shapes::l_bracket(2));
  EXPECT_EQ(rounded.mesh.positions, exact.mesh.positions);
  EXPECT_EQ(rounded.report.output_rounding, 0);
  EXPECT_EQ(rounded.report.verified.deviation, exact.report.verified.deviation);
}

TEST(round_for_format, a_part_at_map_coordinates_is_refused_with_reason_step_and_formats) {
  const Error error = test::error_of([] { in_floats(at_map_coordinates(2)); });
  EXPECT_EQ(error.code, Code::kNotAcceptable);
  EXPECT_EQ(error.option, "format");
  // Floats from 2^22 to 2^23 are a half apart.
  EXPECT_THAT(error.what(), HasSubstr("0.5 apart"));
  EXPECT_THAT(error.what(), HasSubstr("moves a vertex"));
  EXPECT_THAT(error.what(), HasSubstr("obj, json, stl_ascii, ply, off, vtu, msh, mesh, smesh, ply_ascii"));
  EXPECT_THAT(error.what(), HasSubstr("local_origin=true"));
}

TEST(round_for_format, what_floats_cannot_hold_stays_in_doubles_if_that_is_allowed) {
  RunControl control;
  const Result kept = remesh_surface(at_map_coordinates(2), unrefined(),
                                     {.storage = Storage::kFloat, .rounding = OutputRounding::kIfHeld}, control);
  const Result exact = in_doubles(at_map_coordinates(2));
  EXPECT_TRUE(kept.is_not_held);
  EXPECT_EQ(kept.mesh.positions, exact.mesh.positions);
  EXPECT_EQ(kept.report.output_rounding, 0);
  const auto told = std::find_if(kept.report.diagnostics.begin(), kept.report.diagnostics.end(),
                                 [](const Diagnostic& d) { return d.code == DiagnosticCode::kOutputAsText; });
  ASSERT_NE(told, kept.report.diagnostics.end());
  EXPECT_THAT(told->message, HasSubstr("0.5 apart"));
  EXPECT_THAT(told->message, HasSubstr("local_origin=true"));
}

TEST(round_for_format, refinement_makes_no_edge_that_floats_cannot_tell_apart) {
  // A wedge of a thousandth, at 2^17: floats are 1/64 apart there. Angles of 25 degrees ask for edges far below that at
  // its tip.
  const PolygonMesh wedge = shapes::moved(
      shapes::from_lists({{0, 0, 0}, {64, 0, 0}, {64, 0.0625, 0}, {64, 32, 0}, {0, 32, 0}}, {{0, 1, 2}, {0, 2, 3, 4}}),
      {131072, 131072, 0});
  const Result result = in_floats(wedge, Options{});
  double shortest = 64;
  for (const Triangle& t : result.mesh.faces)
    for (int i = 0; i < 3; ++i)
      shortest = std::min(shortest, norm(result.mesh.positions[t[i]] - result.mesh.positions[t[(i + 1) % 3]]));
  // The input has an edge of 4 steps.
  EXPECT_GE(shortest, 4.0 / 64);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.report.min_edge_length, 8.0 / 64);
}

TEST(round_for_format, it_is_written_about_a_named_origin_if_that_is_asked_for) {
  Options local = unrefined();
  local.local_origin = true;
  const Result exact = in_doubles(at_map_coordinates(2)), rounded = in_floats(at_map_coordinates(2), local);
  ASSERT_TRUE(rounded.report.output_origin);
  const Vec3 origin = *rounded.report.output_origin;
  // Few digits: whole numbers, and none on the axis that needs none... but the height is 100, far from a part of 4.
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(origin[axis], std::round(origin[axis]));
  EXPECT_TRUE(are_floats(rounded));
  EXPECT_DOUBLE_EQ(rounded.report.output_rounding, largest_difference(rounded, exact, origin));
  EXPECT_LE(rounded.report.output_rounding, 1e-6 * exact.report.input.bounding_box.diagonal());
  EXPECT_NEAR(*rounded.report.output.volume, *exact.report.output.volume, rounded.report.volume_bound);
  // The box is the model's.
  EXPECT_NEAR(rounded.report.output.bounding_box.min.y, exact.report.output.bounding_box.min.y, 1e-5);
  EXPECT_TRUE(rounded.report.verified.all_true());
}

TEST(round_for_format, an_origin_is_used_only_where_it_is_needed) {
  Options local = unrefined();
  local.local_origin = true;
  EXPECT_FALSE(in_floats(shapes::rotated(shapes::l_bracket(2), {1, 2, 3}, 40), local).report.output_origin);
}

TEST(round_for_format, an_origin_that_does_not_help_is_not_offered) {
  // Two boxes, tiny and far apart: wherever the origin is, one of them is too far from it.
  const PolygonMesh tiny = shapes::scaled(shapes::box({1, 1, 1}), 1e-3);
  const PolygonMesh far = shapes::joined(shapes::moved(tiny, {1e6, 0, 0}), shapes::moved(tiny, {-1e6, 0, 0}));
  for (const bool local_origin : {false, true}) {
    Options options = unrefined();
    options.local_origin = local_origin;
    const Error error = test::error_of([&] { in_floats(far, options); });
    EXPECT_EQ(error.code, Code::kNotAcceptable);
    EXPECT_THAT(error.what(), Not(HasSubstr("local_origin")));
  }
}

TEST(round_for_format, coordinates_beyond_floats_and_below_them_are_refused) {
  const Error large = test::error_of([] { in_floats(shapes::scaled(shapes::box({1, 1, 1}), 1e39)); });
  EXPECT_EQ(large.code, Code::kNotAcceptable);
  EXPECT_THAT(large.what(), HasSubstr("beyond"));
  const Error small = test::error_of([] { in_floats(shapes::scaled(shapes::box({1, 1, 1}), 1e-45)); });
  EXPECT_EQ(small.code, Code::kNotAcceptable);
  EXPECT_TRUE(are_floats(in_floats(shapes::scaled(shapes::box({1, 1, 1}), 1e-30))));
}

TEST(round_for_format, thin_walls_are_kept_or_refused) {
  // A hollow box with walls of `wall`, one part in a hundred thousand of its size away from 0. Half a step of floats
  // there is 3.1e-8 of the size.
  for (const double wall : {1e-3, 1e-6, 1e-7, 3e-8}) {
    const PolygonMesh hollow = shapes::joined(
        shapes::box({1, 1, 1}),
        shapes::moved(shapes::scaled(shapes::turned_over(shapes::box({1, 1, 1})), 1 - 2 * wall), {wall, wall, wall}));
    const PolygonMesh turned = shapes::moved(shapes::rotated(hollow, {1, 2, 3}, 40), {0.6, 0.7, 0.8});
    try {
      const Result rounded = in_floats(turned);
      EXPECT_EQ(rounded.report.output.intersecting_pairs, 0u) << wall;
    } catch (const Error& error) {
      EXPECT_EQ(error.code, Code::kNotAcceptable);
      EXPECT_LT(wall, 5e-7) << error.what();
    }
  }
}

double least_angle_deg(const Result& result, const Triangle& t) {
  double least = 180;
  for (int i = 0; i < 3; ++i) {
    const Vec3 at = result.mesh.positions[t[i]];
    const Vec3 a = result.mesh.positions[t[(i + 1) % 3]] - at, b = result.mesh.positions[t[(i + 2) % 3]] - at;
    least = std::min(least, std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi);
  }
  return least;
}

TEST(round_for_format, angles_that_rounding_costs_are_listed) {
  // Facets of one triangle each, whose least angle is a little above the bound, turned in many ways: rounding to floats
  // makes some of these angles a little smaller.
  Options options;
  options.min_angle_deg = 30;
  PolygonMesh all;
  for (int i = 0; i < 40; ++i) {
    const double angle = (30 + 1e-6) * std::numbers::pi / 180;
    const PolygonMesh one =
        shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {std::cos(angle), std::sin(angle), 0}}, {{0, 1, 2}});
    const PolygonMesh placed = shapes::moved(shapes::rotated(one, {0, 0, 1}, 7.3 * i), {3.1 * i, 10, 1});
    all = i == 0 ? placed : shapes::joined(all, placed);
  }
  const Result exact = in_doubles(all, options), rounded = in_floats(all, options);
  ASSERT_TRUE(exact.report.unrefined.empty());
  std::uint64_t smaller = 0;
  for (const Triangle& t : rounded.mesh.faces) smaller += least_angle_deg(rounded, t) < 30 * (1 - 1e-9);
  ASSERT_GT(smaller, 0u);
  ASSERT_LT(smaller, rounded.mesh.faces.size());
  ASSERT_EQ(rounded.report.unrefined.size(), 1u);
  EXPECT_EQ(rounded.report.unrefined[0].reason, UnrefinedReason::kOutputRounding);
  EXPECT_EQ(rounded.report.unrefined[0].count, smaller);
}

TEST(round_for_format, an_edge_as_long_as_allowed_that_is_rounded_up_is_no_fault) {
  Options options;
  options.max_edge_length = 0.1;
  const Result rounded = in_floats(shapes::box({1, 1, 1}), options);
  double longest = 0;
  for (const Triangle& t : rounded.mesh.faces)
    for (int i = 0; i < 3; ++i)
      longest = std::max(longest, norm(rounded.mesh.positions[t[i]] - rounded.mesh.positions[t[(i + 1) % 3]]));
  EXPECT_GT(longest, 0.1 * (1 + 1e-9));
  EXPECT_LE(longest, 0.1 + 2 * rounded.report.output_rounding);
  EXPECT_TRUE(rounded.report.unrefined.empty());
}

STAGE(round_for_format, test::kWorkers) {
  Options options;
  options.max_edge_length = 0.15;
  options.local_origin = true;
  const Result result = in_floats(at_map_coordinates(1), options, trial.workers);
  trial.mesh(result.mesh);
  trial.in_order(result.report.output_origin.value(), result.report.output_rounding, result.report.volume_bound);
}

}  // namespace
}  // namespace remesh
