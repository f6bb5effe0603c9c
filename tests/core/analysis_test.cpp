/// Tests what an analysis says that a remeshing will make.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/remesh.h"
#include "tests/support/errors.h"
#include "tests/support/hostile_families.h"
#include "tests/support/invariance.h"
#include "tests/support/primitives.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/time_limit.h"
#include "tests/support/time_to_stop.h"

namespace remesh {
namespace {

struct Member {
  std::string name;
  PolygonMesh mesh;
};

/// Makes a terrain over n x n squares, with random heights and two triangles for each square.
PolygonMesh terrain(int n, double height, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> heights(0, height), noise(-0.3, 0.3);
  PolygonMesh mesh = shapes::sheet(n, n, n, n);
  for (Vec3& p : mesh.positions) p += Vec3{noise(random), noise(random), heights(random)};
  return mesh;
}

std::vector<Member> small_surfaces() {
  return {{"box", shapes::box({10, 4, 1})},
          {"thin plate", shapes::box({10, 10, 0.001})},
          {"cylinder", primitives::cylinder(48, 1, 3).mesh},
          {"terrain", terrain(12, 1.5, 7)},
          {"plate with a hole", shapes::plate_with_round_hole(32)},
          {"fan", hostile::family("fan_around_a_vertex").make(12)},
          {"needles", hostile::family("parallel_needles").make(30)},
          {"strip over itself", shapes::strip_over_itself()}};
}

std::vector<Options> settings() {
  Options gaps, planar, target, curved, limited, floor;
  gaps.proximity = 0.5;
  planar.refine = false;
  target.target_faces = 700;
  curved.elements_per_circle = 12;
  limited.max_output_faces = 400;
  floor.min_edge_length = 0.01;
  return {Options(), gaps, planar, target, curved, limited, floor};
}

TEST(analysis, it_knows_the_faces_that_a_remeshing_makes_of_a_small_surface) {
  for (const Member& member : small_surfaces())
    for (const Options& options : settings()) {
      const double made = static_cast<double>(refined(member.mesh, options).mesh.faces.size());
      EXPECT_EQ(predicted_faces(member.mesh, options), made) << member.name;
    }
}

TEST(analysis, the_floor_and_the_largest_edge_are_those_of_the_remeshing) {
  const PolygonMesh needles = hostile::family("parallel_needles").make(30);
  Options target;
  target.target_faces = 700;
  for (const Options& options : {Options(), target}) {
    RunControl control;
    const Report analysed = analyze_surface(needles, options, {}, control), made = refined(needles, options).report;
    EXPECT_EQ(analysed.min_edge_length, made.min_edge_length);
    EXPECT_EQ(analysed.largest_edge_for_target, made.largest_edge_for_target);
  }
}

TEST(analysis, what_would_take_long_to_count_is_predicted) {
  const auto expect_within = [](double factor, const PolygonMesh& mesh, const Options& options) {
    ASSERT_GT(mesh.corners.size() - 2 * mesh.face_count(), 10000u);
    const double predicted = predicted_faces(mesh, options);
    const double made = static_cast<double>(refined(mesh, options).mesh.faces.size());
    EXPECT_LT(std::fabs(std::log(predicted / made)), std::log(factor)) << predicted << " instead of " << made;
  };
  expect_within(2, shapes::sphere(6), {});  // remeshed as a sphere
  expect_within(1.5, shapes::box({1, 1, 1}, 45), with_length(0.05));
  expect_within(3, terrain(75, 2, 7), with_angle(30));
}

TEST(analysis, what_has_too_many_faces_to_count_is_predicted) {
  // The box would have over 524,288 faces.
  const double predicted = predicted_faces(shapes::box({1, 1, 1}), with_length(0.004));
  EXPECT_GT(predicted, 0x1p19);
  EXPECT_LT(predicted, 0x1p21);
}

TEST(analysis, what_cannot_be_made_is_predicted_all_the_same) {
  Options options = with_length(0.01);
  options.max_output_faces = 1000;
  EXPECT_EQ(test::error_of([&] { refined(shapes::box({1, 1, 1}), options); }).code, Code::kOutputTooLarge);
  EXPECT_GT(predicted_faces(shapes::box({1, 1, 1}), options), 10000);
}

TEST(analysis, a_stop_is_obeyed_while_faces_are_counted) {
  // Counting takes over a second.
  const Options fine = with_length(0.006);
  const auto took = test::time_to_stop(std::chrono::milliseconds(300), [&](RunControl& control) {
    analyze_surface(shapes::box({1, 1, 1}), fine, {1, false}, control);
  });
  ASSERT_TRUE(took);
  test::expect_within(test::Seconds(1), *took, "asked after 300 ms");
}

TEST(analysis, the_number_is_the_same_for_any_number_of_threads) {
  Options gaps;
  gaps.proximity = 0.5;
  for (const PolygonMesh& mesh : {shapes::plate_with_round_hole(32), terrain(12, 1.5, 7), shapes::sphere(5)})
    EXPECT_EQ(predicted_faces(mesh, gaps, 1), predicted_faces(mesh, gaps, 8));
}

}  // namespace
}  // namespace remesh
