// The plane tolerance through the pipeline's entry: given as an option, or told from the input's digits.

#include <gtest/gtest.h>

#include "core/remesh.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

Result remeshed(const PolygonMesh& mesh, const Options& options = unrefined()) {
  RunControl control;
  return remesh_surface(mesh, options, RunSettings{}, control);
}

TEST(plane_tolerance, near_the_largest_doubles_the_tolerance_comes_from_the_digits_as_anywhere) {
  const PolygonMesh mesh = shapes::rounded(shapes::rotated(shapes::box({1, 2, 3}, 5), {1, 2, 3}, 40), 1e-6);
  const Result expected = remeshed(mesh);
  const double scale = 0x1p1000;
  const Result result = remeshed(shapes::scaled(mesh, scale));
  EXPECT_EQ(result.mesh.faces.items(), expected.mesh.faces.items());
  EXPECT_EQ(result.report.plane_tolerance, scale * expected.report.plane_tolerance);
  EXPECT_EQ(result.report.rounding_step, scale * expected.report.rounding_step);
}

TEST(plane_tolerance, noise_within_a_given_tolerance_merges_and_beyond_it_does_not) {
  Random random(1);
  PolygonMesh mesh = shapes::sheet(1, 1, 6, 6);
  for (Vec3& p : mesh.positions) p.z = random.uniform(-1e-4, 1e-4);
  Options wide = unrefined(), narrow = unrefined();
  wide.plane_tolerance = 1e-3;
  narrow.plane_tolerance = 1e-6;
  const Result merged = remeshed(mesh, wide), kept = remeshed(mesh, narrow);
  EXPECT_EQ(merged.report.patches.size(), 1u);
  EXPECT_EQ(merged.mesh.faces.size(), 2u);
  EXPECT_LE(merged.report.verified.deviation, 1e-3);
  EXPECT_FALSE(merged.report.plane_tolerance_is_automatic);
  EXPECT_EQ(merged.report.plane_tolerance, 1e-3);
  EXPECT_GT(kept.report.patches.size(), 60u);
  EXPECT_TRUE(kept.report.verified.all_true());
}

TEST(plane_tolerance, the_automatic_tolerance_given_as_an_option_does_the_same) {
  // Two squares, each with a corner that is lifted: by two steps of the coordinates, and by four, which is more than
  // printing explains.
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0},
                                               {1, 0, 0},
                                               {1, 1, 0.002},
                                               {0, 1, 0},
                                               {30.001, 0.003, 0},
                                               {31.001, 0.003, 0},
                                               {31.001, 1.003, 0.004},
                                               {30.001, 1.003, 0}},
                                              {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}});
  const Result automatic = remeshed(mesh);
  EXPECT_TRUE(automatic.report.plane_tolerance_is_automatic);
  EXPECT_EQ(automatic.report.patches.size(), 3u);
  const auto patches_at = [&](double factor) {
    Options options = unrefined();
    options.plane_tolerance = factor * automatic.report.plane_tolerance;
    const Result given = remeshed(mesh, options);
    EXPECT_FALSE(given.report.plane_tolerance_is_automatic);
    EXPECT_EQ(given.report.plane_tolerance, *options.plane_tolerance);
    return given.report.patches.size();
  };
  EXPECT_EQ(patches_at(1), 3u);
  EXPECT_EQ(patches_at(0.9), 3u);
  EXPECT_EQ(patches_at(0.1), 4u);
  EXPECT_EQ(patches_at(1.1), 2u) << "more than the digits explain was asked for";
}

}  // namespace
}  // namespace remesh
