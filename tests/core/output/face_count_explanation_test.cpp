#include "core/output/report/face_count_explanation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Predictions are promised to be right within this factor (prediction.h).
constexpr double kPromised = 3;

const Diagnostic* find_face_count_explanation(const std::vector<Diagnostic>& diagnostics) {
  const auto found = std::find_if(diagnostics.begin(), diagnostics.end(),
                                  [](const Diagnostic& d) { return d.code == DiagnosticCode::kManyFaces; });
  return found == diagnostics.end() ? nullptr : &*found;
}

/// The number that follows some words of a message, without its commas; 0 if the words are not there.
double number_after(const std::string& message, const std::string& words) {
  const std::size_t at = message.find(words);
  if (at == std::string::npos) return 0;
  std::string digits = message.substr(at + words.size());
  std::erase(digits, ',');
  return std::strtod(digits.c_str(), nullptr);
}

void expect_within(double predicted, double counted, double factor, const std::string& what) {
  EXPECT_LE(predicted, factor * counted) << what;
  EXPECT_GE(predicted, counted / factor) << what;
}

/// A box of 12 triangles, two in each of its 6 patches, whose faces are told by functions.
class a_box_with_many_faces : public testing::Test {
 protected:
  std::vector<Diagnostic> explained(const std::function<double(PatchId)>& faces,
                                    const std::function<double(const Goals&)>& predict) {
    std::vector<Diagnostic> diagnostics;
    explain_face_count({chain_.surface,
                        chain_.patches,
                        {faces, RefinedFaces::Are::kCounted},
                        12,
                        std::sqrt(3.0),
                        options_,
                        goals_of(options_, std::sqrt(3.0)),
                        0,
                        [&](PatchId) { return are_curved_; },
                        predict,
                        [&] { return by_circles_; }},
                       diagnostics);
    return diagnostics;
  }

  const StageChain chain_{shapes::box({1, 1, 1})};
  Options options_;
  bool are_curved_ = false;
  std::map<int, std::uint64_t> by_circles_;
};

TEST_F(a_box_with_many_faces, is_explained_only_above_a_thousand_faces) {
  const auto predict = [](const Goals&) { return 6.0; };
  EXPECT_TRUE(explained([](PatchId) { return 1000 / 6.0 - 0.001; }, predict).empty());
  EXPECT_EQ(explained([](PatchId) { return 1001 / 6.0; }, predict).size(), 1u);
}

TEST_F(a_box_with_many_faces, is_explained_by_the_size_if_few_faces_are_predicted_without_it) {
  options_.max_edge_length = 0.01;
  // The area of 6 over that of triangles of this edge; the scale of predictions does not matter.
  const auto of_size = [](const Goals& goals) {
    return std::isfinite(goals.max_edge_length) ? 8 / (goals.max_edge_length * goals.max_edge_length) : 12;
  };
  const auto found = explained([](PatchId) { return 160000 / 6.0; }, of_size);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].code, DiagnosticCode::kManyFaces);
  EXPECT_THAT(found[0].message, HasSubstr("mostly because of the largest edge that was asked for"));
  // 160,000 / 4^4 is the first number below 1,000.
  EXPECT_THAT(found[0].message, HasSubstr("max_edge_length=0.16 would give about 630 faces"));
  EXPECT_THAT(found[0].message, Not(HasSubstr("min_angle_deg=")));
}

TEST_F(a_box_with_many_faces, is_explained_by_angles_and_lists_the_faces_of_the_largest_patches) {
  const auto of_angle = [](const Goals& goals) {
    if (goals.min_edge_length > 0) return 12 + 1e-3 / goals.min_edge_length;
    return 100 * goals.min_angle_deg;
  };
  // One patch has more than half of all faces.
  const auto found = explained([](PatchId p) { return p == PatchId(4) ? 3000.0 : 100.0; }, of_angle);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].count, 2u);
  std::vector<std::uint64_t> expected;
  for (std::size_t f = 0; f < 12; ++f)
    if (chain_.patch_of(f) == PatchId(4)) expected.push_back(f);
  EXPECT_EQ(found[0].elements, expected);
  EXPECT_THAT(found[0].message, HasSubstr("the result has 3,500 faces, 292 times the input's 12 triangles, mostly "
                                          "because the bound on angles divides needles"));
  EXPECT_THAT(found[0].message, HasSubstr("half of them are in 1 patch"));
  // 3,500 faces for a bound of 25 degrees are 1,400 for one of 10; and a floor of 2^-20 of the diagonal is too low.
  EXPECT_THAT(found[0].message, HasSubstr("min_angle_deg=10 would give about 1,400 faces and min_edge_length="));
}

TEST_F(a_box_with_many_faces, is_told_of_facets_of_curved_surfaces_and_of_elements_per_circle) {
  are_curved_ = true;
  by_circles_ = {{8, 300}, {16, 700}, {24, 1100}};
  const auto found =
      explained([](PatchId) { return 1000.0; }, [](const Goals& goals) { return 12 + goals.min_angle_deg; });
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].message, HasSubstr("the facets of curved surfaces are narrow"));
  EXPECT_THAT(found[0].message, HasSubstr("elements_per_circle=16 would give about 700 faces"));
}

TEST(many_faces, of_a_plate_with_a_size_are_as_many_with_the_option_that_is_named) {
  Options options;
  options.max_edge_length = 0.02;
  const PolygonMesh box = shapes::box({1, 2, 3});
  const Result result = remeshed(box, options);
  const Diagnostic* const many = find_face_count_explanation(result.report.diagnostics);
  ASSERT_NE(many, nullptr);
  Options named = options;
  named.max_edge_length = number_after(many->message, "max_edge_length=");
  ASSERT_GT(*named.max_edge_length, 0.02);
  const Result coarse = remeshed(box, named);
  // Sizes alone decide, so predictions are much better than promised in general.
  expect_within(number_after(many->message, "would give about "), static_cast<double>(coarse.mesh.faces.size()), 1.5,
                many->message);
  EXPECT_EQ(find_face_count_explanation(coarse.report.diagnostics), nullptr);
}

TEST(many_faces, of_narrow_facets_are_as_many_with_the_options_that_are_named) {
  // A rod with narrow facets: each needs length / width pieces or so.
  const PolygonMesh rod = shapes::cylinder(96, 1, 6);
  Options with_facets;
  with_facets.coarsens_fine_facets = false;
  const Result result = remeshed(rod, with_facets);
  const Diagnostic* const many = find_face_count_explanation(result.report.diagnostics);
  ASSERT_NE(many, nullptr);
  Options named;
  named.elements_per_circle = number_after(many->message, "elements_per_circle=");
  ASSERT_GE(*named.elements_per_circle, 3) << many->message;
  const Result round = remeshed(rod, named);
  expect_within(number_after(many->message, "would give about "), static_cast<double>(round.mesh.faces.size()),
                kPromised, many->message);
}

TEST(many_faces, without_a_floor_that_was_found_are_as_many_as_is_told) {
  // Each long side needs about 1,700 pieces, and 20 faces a triangle and 1,000 are 1,240.
  const PolygonMesh beam = shapes::box({1, 1, 3000});
  const Result result = remeshed(beam, {});
  ASSERT_GT(result.report.min_edge_length, 0);
  const Diagnostic* const many = find_face_count_explanation(result.report.diagnostics);
  ASSERT_NE(many, nullptr);
  std::uint64_t left = 0;
  for (const Unrefined& of_reason : result.report.unrefined)
    if (of_reason.reason == UnrefinedReason::kSizeFloor) left = of_reason.count;
  EXPECT_GT(left, 0u);
  EXPECT_EQ(number_after(many->message, "which left "), static_cast<double>(left)) << many->message;
  Options without;
  without.min_edge_length = 0;
  const double told = number_after(many->message, "min_edge_length=0 would give about ");
  ASSERT_GT(told, 0) << many->message;
  expect_within(told, static_cast<double>(remeshed(beam, without).mesh.faces.size()), 1.5, many->message);
}

TEST(many_faces, names_options_that_need_no_floor_where_the_floor_leaves_all_facets) {
  // All facets are of one width, so no floor leads to a number of faces between a few hundred and 36,000.
  const PolygonMesh rod = shapes::cylinder(96, 1, 40);
  Options with_facets;
  with_facets.coarsens_fine_facets = false;
  const Result result = remeshed(rod, with_facets);
  ASSERT_GT(result.report.min_edge_length, 0);
  EXPECT_LT(result.mesh.faces.size(), 1000u);
  const Diagnostic* const many = find_face_count_explanation(result.report.diagnostics);
  ASSERT_NE(many, nullptr);
  EXPECT_THAT(many->message, HasSubstr("faces without a floor"));
  Options named;
  named.elements_per_circle = number_after(many->message, "elements_per_circle=");
  ASSERT_GE(*named.elements_per_circle, 3) << many->message;
  const Result round = remeshed(rod, named);
  EXPECT_EQ(round.report.min_edge_length, 0);
  expect_within(
      number_after(many->message, std::to_string(static_cast<int>(*named.elements_per_circle)) + " would give about "),
      static_cast<double>(round.mesh.faces.size()), kPromised, many->message);
}

TEST(many_faces, are_not_told_where_only_details_set_a_floor) {
  Options options;
  options.defeature_size = 0.01;
  const Result result = remeshed(shapes::box({1, 1, 1}), options);
  EXPECT_GT(result.report.min_edge_length, 0);
  EXPECT_EQ(find_face_count_explanation(result.report.diagnostics), nullptr);
}

TEST(many_faces, are_told_beforehand) {
  Options options;
  options.max_edge_length = 0.05;
  RunControl control;
  const Report report = analyze_surface(shapes::box({1, 1, 1}), options, {}, control);
  const Diagnostic* const many = find_face_count_explanation(report.diagnostics);
  ASSERT_NE(many, nullptr);
  EXPECT_THAT(many->message, HasSubstr("faces are expected, "));
  EXPECT_EQ(find_face_count_explanation(analyze_surface(shapes::box({1, 1, 1}), {}, {}, control).diagnostics), nullptr);
}

}  // namespace
}  // namespace remesh
