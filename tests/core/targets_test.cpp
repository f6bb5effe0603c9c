// Tests target_faces and target_edge_length: what is asked for is reached, and only the largest edge is chosen for it.

#include <gtest/gtest.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "core/remesh.h"
#include "tests/support/errors.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

Options with_target(std::uint64_t faces) {
  Options options;
  options.target_faces = faces;
  return options;
}

std::vector<PolygonMesh> plain_shapes() {
  return {shapes::box({3, 2, 1}), shapes::box({1, 1, 1}), solids::stacked_boxes(3, 5)};
}

const Diagnostic* many_faces(const Report& report) {
  for (const Diagnostic& told : report.diagnostics)
    if (told.code == DiagnosticCode::kManyFaces) return &told;
  return nullptr;
}

TEST(targets, so_many_faces_are_made_as_are_asked_for_within_a_tenth) {
  for (const PolygonMesh& mesh : plain_shapes())
    for (const std::uint64_t faces : {3000, 10'000}) {
      const Result result = refined(mesh, with_target(faces));
      expect_promises(mesh, with_target(faces), result);
      const double over = static_cast<double>(result.mesh.faces.size()) / static_cast<double>(faces);
      EXPECT_NEAR(over, 1, 0.1) << faces;
      EXPECT_EQ(many_faces(result.report), nullptr);
    }
}

TEST(targets, the_median_edge_is_as_long_as_is_asked_for_within_a_tenth) {
  for (const double length : {0.05, 0.2}) {
    Options options;
    options.target_edge_length = length;
    const Result result = refined(shapes::box({3, 2, 1}), options);
    std::vector<double> sides;
    for (const Triangle& face : result.mesh.faces)
      for (std::size_t k = 0; k < 3; ++k)
        sides.push_back(norm(result.mesh.positions[face[(k + 1) % 3]] - result.mesh.positions[face[k]]));
    std::sort(sides.begin(), sides.end());
    EXPECT_NEAR(sides[sides.size() / 2], length, 0.1 * length);
  }
}

TEST(targets, a_target_gives_the_same_as_its_largest_edge) {
  const PolygonMesh mesh = shapes::box({3, 2, 1});
  const Result by_target = refined(mesh, with_target(5000));
  Options options;
  options.max_edge_length = by_target.report.largest_edge_for_target;
  const Result by_edge = refined(mesh, options);
  EXPECT_EQ(by_target.mesh.faces.items().size(), by_edge.mesh.faces.items().size());
  EXPECT_TRUE(by_target.mesh.positions == by_edge.mesh.positions);
  EXPECT_TRUE(by_target.mesh.faces == by_edge.mesh.faces);
  EXPECT_EQ(by_edge.report.largest_edge_for_target, 0);
}

TEST(targets, scaled_by_a_power_of_two_the_largest_edge_scales_exactly) {
  const double once = refined(shapes::box({3, 2, 1}), with_target(5000)).report.largest_edge_for_target;
  EXPECT_EQ(refined(shapes::box({24, 16, 8}), with_target(5000)).report.largest_edge_for_target, 8 * once);
}

TEST(targets, fewer_faces_than_the_shape_needs_are_told_with_their_number_and_an_option_that_lowers_it) {
  // Each of the 32 facets is a patch of its own, and it is so narrow that the bound on angles divides it.
  const PolygonMesh mesh = shapes::cylinder(32, 1, 8);
  const Result result = refined(mesh, with_target(100));
  const std::uint64_t faces = result.mesh.faces.size();
  ASSERT_GT(faces, 200u);
  EXPECT_EQ(result.report.largest_edge_for_target, HUGE_VAL);
  const Diagnostic* told = many_faces(result.report);
  ASSERT_NE(told, nullptr);
  EXPECT_NE(told->message.find("target_faces=100 is not met: the other options alone need"), std::string::npos)
      << told->message;
  ASSERT_FALSE(told->remedies.empty());
  const std::string_view name = "elements_per_circle=", remedy = told->remedies.front().options;
  ASSERT_TRUE(remedy.starts_with(name)) << remedy;
  double elements = 0;
  std::from_chars(remedy.data() + name.size(), remedy.data() + remedy.size(), elements);
  Options options = with_target(100);
  options.elements_per_circle = elements;
  EXPECT_LT(static_cast<double>(refined(mesh, options).mesh.faces.size()), 0.8 * static_cast<double>(faces));
}

TEST(targets, an_analysis_predicts_the_target_or_what_is_needed_in_any_case) {
  const auto predicted = [](const PolygonMesh& mesh, std::uint64_t faces) {
    RunControl control;
    return analyze_surface(mesh, with_target(faces), {}, control).predicted_faces;
  };
  EXPECT_NEAR(static_cast<double>(predicted(shapes::box({3, 2, 1}), 5000)), 5000, 500);
  EXPECT_EQ(predicted(shapes::box({3, 2, 1}, 60), 50000), 50000u);  // these are too many triangles to be counted
  EXPECT_GT(predicted(shapes::cylinder(32, 1, 8), 100), 200u);
}

TEST(targets, options_that_a_target_chooses_are_refused_beside_it) {
  const auto is_refused = [](const Options& options) {
    return test::error_of([&] { check_options(options); }).code == Code::kInvalidOption;
  };
  Options edge = with_target(100), fraction = with_target(100), both = with_target(100), none = with_target(100);
  edge.max_edge_length = 1;
  fraction.max_edge_fraction = 0.1;
  both.target_edge_length = 1;
  none.refine = false;
  for (const Options& options : {edge, fraction, both, none}) EXPECT_TRUE(is_refused(options));
  Options length;
  length.target_edge_length = 1;
  length.max_edge_length = 1;
  EXPECT_TRUE(is_refused(length));
}

}  // namespace
}  // namespace remesh
