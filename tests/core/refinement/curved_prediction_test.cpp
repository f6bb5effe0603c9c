#include "core/refinement/prediction/curved_prediction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/free_shapes.h"
#include "tests/support/own_meshes.h"
#include "tests/support/primitives.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"

namespace remesh {
namespace {

using FacesByElements = std::map<int, std::uint64_t>;

/// Options with a bound on angles, or without any refinement.
Options refined_to(double degrees) {
  Options options;
  options.refine = degrees > 0;
  if (options.refine) options.min_angle_deg = degrees;
  return options;
}

FacesByElements predicted_by_elements(const PolygonMesh& mesh, const Options& options) {
  RunControl control;
  return analyze_surface(mesh, options, RunSettings{}, control).predicted_faces_by_elements_per_circle;
}

/// Tells whether all curved surfaces of a result were remeshed as a whole. A surface whose distance cannot be proven
/// falls back to its facets, and no prediction can foresee that.
bool is_remeshed_as_a_whole(const Report& report) {
  constexpr std::uint64_t kMaxPieces = 8;
  return std::all_of(report.surfaces.surfaces.begin(), report.surfaces.surfaces.end(), [](const RecognisedSurface& s) {
    return s.shape.kind == SurfaceKind::kPlane || s.patches <= kMaxPieces;
  });
}

/// Expects that predictions for models are right within a factor, wherever these are remeshed as a whole.
void expect_right_within(double factor, const std::vector<primitives::Model>& models, const Options& options) {
  RunControl control;
  int judged = 0, left_out = 0;
  for (const primitives::Model& model : models)
    for (const auto& [elements, faces] : predicted_by_elements(model.mesh, options)) {
      Options with_circles = options;
      with_circles.elements_per_circle = elements;
      const Result result = remesh_surface(model.mesh, with_circles, RunSettings{}, control);
      ++(is_remeshed_as_a_whole(result.report) ? judged : left_out);
      if (!is_remeshed_as_a_whole(result.report)) continue;
      const double truth = static_cast<double>(result.mesh.faces.size());
      EXPECT_LT(std::fabs(std::log(static_cast<double>(faces) / truth)), std::log(factor))
          << model.name << ", " << elements << " elements: " << faces << " instead of " << truth;
    }
  EXPECT_GE(judged, 3 * left_out);
}

/// Remeshes and counts.
double true_count(const PolygonMesh& mesh, Options options, int elements) {
  options.elements_per_circle = elements;
  RunControl control;
  return static_cast<double>(remesh_surface(mesh, options, RunSettings{}, control).mesh.faces.size());
}

PolygonMesh read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  return read_mesh(sniff_format(content), content, ReadLimits{}, control).mesh;
}

std::vector<primitives::Model> models() {
  return {primitives::cylinder(72, 10, 30), primitives::plates_with_a_common_bore(64), primitives::tube(48, 10, 2, 20),
          primitives::rounded_box({10, 8, 6}, 2, 12), primitives::frustum(60, 10, 6, 15)};
}

TEST(curved_prediction, without_refinement_it_is_right_within_a_factor_of_one_and_three_quarters) {
  expect_right_within(1.75, models(), refined_to(0));
}

TEST(curved_prediction, with_a_bound_on_angles_it_is_right_within_a_factor_of_two) {
  expect_right_within(2, models(), refined_to(25));
}

TEST(curved_prediction, free_surfaces_are_right_within_a_factor_of_two) {
  for (const PolygonMesh& mesh : {bumpy_ball(5), hills(96), relief(24)})
    for (const double angle : {0.0, 25.0}) {
      const FacesByElements predicted = predicted_by_elements(mesh, refined_to(angle));
      ASSERT_EQ(predicted.size(), 5u);
      for (const int elements : {8, 24}) {
        const double truth = true_count(mesh, refined_to(angle), elements);
        ASSERT_LT(truth, 0.5 * static_cast<double>(mesh.face_count()));
        EXPECT_LT(std::fabs(std::log(static_cast<double>(predicted.at(elements)) / truth)), std::log(2))
            << elements << " elements: " << predicted.at(elements) << " instead of " << truth;
      }
    }
}

TEST(curved_prediction, of_free_surfaces_a_largest_edge_and_a_tolerance_count) {
  const PolygonMesh mesh = bumpy_ball(5);
  Options edges = refined_to(25), near = refined_to(25);
  edges.max_edge_length = 0.05;
  near.surface_tolerance = 1e-4;
  const double predicted = static_cast<double>(predicted_by_elements(mesh, edges).at(8));
  const double truth = true_count(mesh, edges, 8);
  EXPECT_LT(std::fabs(std::log(predicted / truth)), std::log(2)) << predicted << " instead of " << truth;
  // The tolerance makes the surface coarser, and then nothing is told of other numbers.
  EXPECT_TRUE(predicted_by_elements(mesh, near).empty());
}

TEST(curved_prediction, free_surfaces_that_options_keep_are_not_counted_as_coarser) {
  const PolygonMesh mesh = bumpy_ball(3);
  Options options = refined_to(25);
  EXPECT_EQ(predicted_by_elements(mesh, options).size(), 5u);
  options.keep_boundary_vertices = true;
  EXPECT_TRUE(predicted_by_elements(mesh, options).empty());
}

TEST(curved_prediction, the_bracket_is_right_within_a_factor_of_one_and_a_quarter) {
  const PolygonMesh mesh = read_file(test::own_meshes_folder() / "bracket.obj");
  for (const double angle : {0.0, 25.0})
    for (const auto& [elements, faces] : predicted_by_elements(mesh, refined_to(angle))) {
      const double truth = true_count(mesh, refined_to(angle), elements);
      EXPECT_LT(std::fabs(std::log(static_cast<double>(faces) / truth)), std::log(1.25))
          << elements << " elements: " << faces << " instead of " << truth;
    }
}

TEST(curved_prediction, real_parts_are_right_within_a_factor_of_two) {
  for (const char* const name : {"curved-cad/cylinder.stl", "curved-cad/sv_cylinder.stl", "curved-cad/unit_sphere.STL",
                                 "planar-cad/part1.stl", "planar-cad/1002_tray_bottom.STL"}) {
    if (!test::has_shared_mesh(name)) return;
    const PolygonMesh mesh = read_file(test::shared_meshes_folder() / name);
    for (const double angle : {0.0, 25.0}) {
      const FacesByElements faces = predicted_by_elements(mesh, refined_to(angle));
      for (const int elements : {12, 24}) {
        const double truth = true_count(mesh, refined_to(angle), elements);
        EXPECT_LT(std::fabs(std::log(static_cast<double>(faces.at(elements)) / truth)), std::log(2))
            << name << ", " << elements << " elements: " << faces.at(elements) << " instead of " << truth;
      }
    }
  }
}

TEST(curved_prediction, a_low_cylinder_is_counted_exactly) {
  // Each half is a strip of triangles between its rims, and each cap is a polygon: 2 n + 2 (n - 2) triangles.
  const primitives::Model model = primitives::cylinder(72, 10, 0.5);
  for (const auto& [elements, faces] : predicted_by_elements(model.mesh, refined_to(0))) {
    EXPECT_EQ(faces, 4 * static_cast<std::uint64_t>(elements) - 4);
    EXPECT_EQ(true_count(model.mesh, refined_to(0), elements), 4.0 * elements - 4);
  }
}

TEST(curved_prediction, it_grows_with_the_number_of_elements) {
  for (const primitives::Model& model : primitives::explained())
    for (const double angle : {0.0, 25.0}) {
      const FacesByElements faces = predicted_by_elements(model.mesh, refined_to(angle));
      for (auto a = faces.begin(), b = a; a != faces.end() && ++b != faces.end(); a = b)
        EXPECT_LE(a->second, b->second) << model.name;
    }
}

TEST(curved_prediction, it_tells_five_numbers_whatever_the_tolerance_of_surfaces_is) {
  const primitives::Model model = primitives::cylinder(72, 10, 30);
  for (const double tolerance : {0.0, 0.1}) {
    Options options = refined_to(0);
    options.surface_tolerance = tolerance;
    const FacesByElements faces = predicted_by_elements(model.mesh, options);
    std::vector<int> elements;
    for (const auto& [n, count] : faces) elements.push_back(n);
    if (tolerance > 0)
      EXPECT_EQ(elements, (std::vector{8, 12, 16, 24, 36}));
    else
      EXPECT_TRUE(elements.empty()) << "facets stay, whatever the number of elements is";
  }
}

TEST(curved_prediction, nothing_is_told_where_nothing_is_curved) {
  EXPECT_TRUE(predicted_by_elements(shapes::box({1, 2, 3}), refined_to(25)).empty());
  Options facets = refined_to(25);
  facets.feature_angle_deg = 0;
  EXPECT_TRUE(predicted_by_elements(primitives::cylinder(72, 10, 30).mesh, facets).empty());
}

TEST(curved_prediction, a_largest_edge_counts) {
  Options options = refined_to(25);
  options.max_edge_length = 0.5;
  const PolygonMesh mesh = primitives::cylinder(72, 10, 30).mesh;
  for (const auto& [elements, faces] : predicted_by_elements(mesh, options)) {
    const double truth = true_count(mesh, options, elements);
    EXPECT_LT(std::fabs(std::log(static_cast<double>(faces) / truth)), std::log(1.5))
        << elements << " elements: " << faces << " instead of " << truth;
  }
}

}  // namespace
}  // namespace remesh
