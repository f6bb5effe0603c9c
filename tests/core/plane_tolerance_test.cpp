// Tests the plane tolerance through the entry of the pipeline. It is an option, or is derived from the input's digits.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/remesh.h"
#include "tests/support/cgal_space.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

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
  const Result merged = remeshed(mesh, wide), separate = remeshed(mesh, narrow);
  EXPECT_EQ(merged.report.patches.size(), 1u);
  EXPECT_EQ(merged.mesh.faces.size(), 2u);
  EXPECT_LE(merged.report.verified.deviation, 1e-3);
  EXPECT_FALSE(merged.report.plane_tolerance_is_automatic);
  EXPECT_EQ(merged.report.plane_tolerance, 1e-3);
  EXPECT_GT(separate.report.patches.size(), 60u);
  EXPECT_TRUE(separate.report.verified.all_true());
}

/// Returns the distance between a point and the faces of a mesh of triangles.
double distance_to(const Vec3& p, const Result& result) {
  double nearest = HUGE_VAL;
  for (const Triangle& t : result.mesh.faces) {
    const auto corner = [&](int k) { return result.mesh.positions[t[k]]; };
    nearest = std::min(nearest, std::sqrt(cgal_squared_distance(p, {corner(0), corner(1), corner(2)})));
  }
  return nearest;
}

TEST(plane_tolerance, the_deviation_counts_places_inside_faces_that_fold_over) {
  // The tolerance is larger than the sheet is thick in two of its directions, so needles may fold over within it.
  int folded = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    Random random(seed);
    PolygonMesh mesh = shapes::sheet(1, 1, 3, 2);
    for (Vec3& p : mesh.positions) {
      p.y = 4e-6 * (p.y + random.uniform(-1, 1));
      p.z = random.uniform(-1e-7, 1e-7);
    }
    Options options = unrefined();
    options.plane_tolerance = 1e-5;
    const Result result = remeshed(mesh, options);
    double farthest = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.face(FaceId(f));
      for (int i = 0; i < 20; ++i) {
        const double u = random.unit(), v = (1 - u) * random.unit();
        const Vec3 &a = mesh.positions[face[0]], &b = mesh.positions[face[1]], &c = mesh.positions[face[2]];
        farthest = std::max(farthest, distance_to(a + u * (b - a) + v * (c - a), result));
      }
    }
    folded += farthest > 1e-7;
    // Places that are farther by less than a quarter are not looked for, and coordinates have rounding.
    EXPECT_LE(farthest, 1.25 * result.report.verified.deviation + 1e-15) << "seed " << seed;
  }
  EXPECT_GT(folded, 20) << "otherwise this shows nothing";
}

/// Makes a plate of 200 x 100 x 10 with a ridge along the middle of its top. Its faces are polygons as they are drawn.
PolygonMesh crowned_plate(double crown, const Vec3& at = {}) {
  const double top = 10, ridge = top + crown;
  PolygonMesh mesh = shapes::from_lists(
      {{0, 0, 0},
       {200, 0, 0},
       {200, 100, 0},
       {0, 100, 0},
       {0, 0, top},
       {200, 0, top},
       {200, 100, top},
       {0, 100, top},
       {100, 0, ridge},
       {100, 100, ridge}},
      {{0, 3, 2, 1}, {0, 1, 5, 8, 4}, {1, 2, 6, 5}, {2, 3, 7, 9, 6}, {3, 0, 4, 7}, {4, 8, 9, 7}, {8, 5, 6, 9}});
  for (Vec3& p : mesh.positions) p = p + at;
  return mesh;
}

TEST(plane_tolerance, a_crown_in_exact_decimals_stays) {
  for (const double crown : {0.01, 0.005, 0.1, 0.002})
    for (const Vec3& at : {Vec3{}, Vec3{-100, -50, 0}, Vec3{1000, 250.5, 30}}) {
      const Result result = remeshed(crowned_plate(crown, at));
      EXPECT_EQ(result.report.patches.size(), 7u) << crown;
      EXPECT_NEAR(result.report.output.volume.value(), 200'000 + 10'000 * crown, 1e-3 * crown * 10'000) << crown;
      // The file says four decimals at most, of numbers up to 1200.
      EXPECT_LE(result.report.rounding_step, 0.1 * crown);
    }
}

TEST(plane_tolerance, a_crown_stays_among_many_exact_dimensions) {
  // Forty cubes of different sizes beside the plate, in multiples of 0.01 as its crown: the numbers seem to be rounded,
  // but one bend is no noise.
  Random random(1);
  PolygonMesh mesh = crowned_plate(0.01);
  for (int i = 0; i < 40; ++i) {
    const double size = 0.01 * random.integer(31, 99);
    const double y = 120 + 0.01 * random.integer(0, 999), z = 0.01 * random.integer(0, 999);
    const PolygonMesh cube = shapes::moved(shapes::box({size, size, size}), {3.0 * i, y, z});
    mesh = shapes::joined(mesh, shapes::rounded(cube, 0.01));
  }
  const Result result = remeshed(mesh);
  EXPECT_NEAR(result.report.rounding_step, 0.01, 1e-9);
  EXPECT_EQ(result.report.patches.size(), 7u + 40 * 6);
}

TEST(plane_tolerance, an_edge_bumped_by_exact_decimals_keeps_its_bump) {
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {0, 0, 1}, {0.005, 0.005, 0.5}, {-100, 0, 0.5}, {0, -100, 0.5}},
                         {{3, 0, 2}, {3, 2, 1}, {4, 2, 0}, {4, 1, 2}});
  const Result result = remeshed(mesh);
  EXPECT_EQ(result.mesh.faces.size(), 4u);
  EXPECT_EQ(result.report.output.vertices, 5u);
  EXPECT_LE(result.report.rounding_step, 0.005);
}

TEST(plane_tolerance, a_cube_with_the_last_digits_of_printing_is_a_cube) {
  PolygonMesh cube = shapes::box({2, 2, 2});
  cube.positions[VertexId(3)].x += 1e-6;
  cube.positions[VertexId(6)].z -= 1e-6;
  const Result result = remeshed(shapes::rounded(cube, 1e-6));
  EXPECT_EQ(result.report.patches.size(), 6u);
  EXPECT_EQ(result.mesh.faces.size(), 12u);
}

TEST(plane_tolerance, the_automatic_tolerance_given_as_an_option_does_the_same) {
  // Quadrilaterals with a corner that is lifted: by one step of the coordinates, by more, and by four, which is more
  // than printing explains. Triangles apart from them, with as many decimals, prove the step.
  PolygonMesh mesh = shapes::from_lists(
      {{0, 0, 0},
       {1, 0, 0},
       {1, 1, 0.002},
       {0, 1, 0},
       {30.001, 0.003, 0},
       {31.001, 0.003, 0},
       {31.001, 1.003, 0.004},
       {30.001, 1.003, 0},
       {5, 0, 0},
       {6, 0, 0},
       {6, 1, 0.002},
       {5, 0.7, 0},
       {9, 0, 0},
       {10, 0, 0},
       {10, 1, 0.001},
       {9, 1, 0}},
      {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}, {8, 9, 10}, {8, 10, 11}, {12, 13, 14}, {12, 14, 15}});
  Random random(1);
  const auto free = [&](double from) { return std::round(1e3 * (from + random.unit())) / 1e3; };
  constexpr std::size_t kApart = 12;
  for (std::size_t i = 0; i < kApart; ++i) {
    const double x = 2.0 * static_cast<double>(i);
    mesh = shapes::joined(
        mesh,
        shapes::from_lists({{free(x), free(5), free(0)}, {free(x), free(8), free(0)}, {free(x), free(7), free(3)}},
                           {{0, 1, 2}}));
  }
  const Result automatic = remeshed(mesh);
  EXPECT_TRUE(automatic.report.plane_tolerance_is_automatic);
  EXPECT_NEAR(automatic.report.rounding_step, 1e-3, 1e-12);
  EXPECT_EQ(automatic.report.patches.size(), 5 + kApart);
  const auto patches_at = [&](double factor) {
    Options options = unrefined();
    options.plane_tolerance = factor * automatic.report.plane_tolerance;
    const Result given = remeshed(mesh, options);
    EXPECT_FALSE(given.report.plane_tolerance_is_automatic);
    EXPECT_EQ(given.report.plane_tolerance, *options.plane_tolerance);
    return given.report.patches.size();
  };
  EXPECT_EQ(patches_at(1), 5 + kApart);
  EXPECT_EQ(patches_at(0.9), 5 + kApart);
  EXPECT_EQ(patches_at(0.1), 8 + kApart);
  EXPECT_EQ(patches_at(1.1), 4 + kApart) << "more than the digits explain was asked for";
}

TEST(plane_tolerance, a_house_in_whole_centimetres_is_told_which_tolerance_would_do) {
  // Five small blocks, turned, and rounded to a hundredth.
  PolygonMesh house;
  for (int i = 0; i < 5; ++i) {
    PolygonMesh block = shapes::rotated(shapes::box({1.0 + 0.2 * i, 1.5, 0.8}), {1, 2, 3}, 20 + 5.0 * i);
    for (Vec3& p : block.positions) p = p + Vec3{3.0 * i, 1.0 * i, 0};
    house = i == 0 ? block : shapes::joined(house, block);
  }
  house = shapes::rounded(house, 0.01);
  const Result result = remeshed(house);
  EXPECT_NEAR(result.report.rounding_step, 0.01, 1e-12);
  EXPECT_GT(result.report.patches.size(), 30u);
  const auto& all = result.report.diagnostics;
  const auto found = std::find_if(all.begin(), all.end(),
                                  [](const Diagnostic& d) { return d.code == DiagnosticCode::kRoundingCapped; });
  ASSERT_NE(found, all.end());
  EXPECT_NE(found->message.find("plane_tolerance=0.026"), std::string::npos) << found->message;
  Options options = unrefined();
  options.plane_tolerance = 0.026;
  const Result wide = remeshed(house, options);
  EXPECT_EQ(wide.report.patches.size(), 30u);
  EXPECT_EQ(std::count_if(wide.report.diagnostics.begin(), wide.report.diagnostics.end(),
                          [](const Diagnostic& d) { return d.code == DiagnosticCode::kRoundingCapped; }),
            0);
}

TEST(plane_tolerance, what_bends_nowhere_is_not_told_of) {
  // A block whose sides are cut into equal squares.
  const Result result = remeshed(shapes::box({40, 37, 41}, 5));
  for (const Diagnostic& d : result.report.diagnostics) EXPECT_NE(d.code, DiagnosticCode::kRoundingCapped);
}

}  // namespace
}  // namespace remesh
