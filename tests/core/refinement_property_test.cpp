// Random polyhedra and random options: whatever is asked for, the promises hold. What is asserted is measured here
// (tests/support/refined_checks.h), not taken from the report.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/remesh.h"
#include "tests/support/polygons.h"
#include "tests/support/random.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

const std::uint64_t kSeed = base_seed(20183);

constexpr std::uint64_t kMaxFaces = 10'000;

/// Returns random options. Their sizes fit a body of this size.
Options random_options(Random& random, double size) {
  Options options;
  options.max_output_faces = kMaxFaces;
  if (random.chance(0.8)) options.min_angle_deg = random.chance(0.2) ? 33 : random.uniform(0, 33);
  if (random.chance(0.4)) options.max_edge_length = size * random.uniform(0.05, 0.5);
  if (random.chance(0.2)) options.max_area = size * size * random.uniform(0.002, 0.1);
  if (random.chance(0.2)) options.min_edge_length = size * std::pow(10, random.uniform(-4, -1));
  if (options.min_edge_length && options.max_edge_length)
    options.min_edge_length = std::min(*options.min_edge_length, *options.max_edge_length);
  if (random.chance(0.2)) options.gradation = random.uniform(1.2, 3);
  if (random.chance(0.2)) options.proximity = random.uniform(0.2, 1.5);
  if (random.chance(0.1)) options.max_output_faces = static_cast<std::uint64_t>(random.integer(500, 3000));
  options.split_boundaries = !random.chance(0.15);
  options.keep_boundary_vertices = random.chance(0.1);
  return options;
}

std::string words(const Options& o) {
  std::string text;
  const auto add = [&](const char* name, double value) {
    text += std::string(name) + ' ' + std::to_string(value) + ' ';
  };
  add("angle", o.min_angle_deg.value_or(25));
  if (o.max_edge_length) add("max_edge_length", *o.max_edge_length);
  if (o.max_area) add("max_area", *o.max_area);
  if (o.min_edge_length) add("min_edge_length", *o.min_edge_length);
  if (o.gradation) add("gradation", *o.gradation);
  if (o.proximity > 0) add("proximity", o.proximity);
  add("faces", static_cast<double>(*o.max_output_faces));
  if (!o.split_boundaries) text += "locked ";
  if (o.keep_boundary_vertices) text += "kept";
  return text;
}

double size_of(const PolygonMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.positions) box.add(p);
  return box.diagonal();
}

/// Expects that the result keeps the promises, and that neither the number of workers nor a scale by a power of two
/// changes anything.
void expect_refined_well(const PolygonMesh& mesh, const Options& options, double tolerance = 1e-9) {
  Result result;
  try {
    result = refined(mesh, options, 1);
  } catch (const Error& error) {
    // Only what no surface with these sizes could meet is refused; else the budget limits the refinement.
    ASSERT_EQ(code_name(error.code), code_name(Code::kOutputTooLarge)) << error.what();
    ASSERT_TRUE(std::string(error.what()).starts_with("with these sizes")) << error.what();
    return;
  }
  expect_promises(mesh, options, result, tolerance);
  ASSERT_LE(result.mesh.faces.size(), *options.max_output_faces);
  if (options.min_edge_length) {
    RunControl control;
    Options coarse = options;
    coarse.refine = false;
    const double own = shortest_edge(remesh_surface(mesh, coarse, {}, control).mesh);
    EXPECT_GE(shortest_edge(result.mesh), std::min(own, *options.min_edge_length) * (1 - 1e-6));
  }
  if (result.mesh.faces.size() > 5000) return;

  const Result again = refined(mesh, options, 2);
  ASSERT_EQ(again.mesh.faces.items(), result.mesh.faces.items());
  ASSERT_EQ(again.mesh.positions.items(), result.mesh.positions.items());
  Options half = options;
  for (auto* length : {&half.max_edge_length, &half.min_edge_length})
    if (*length) **length /= 2;
  if (half.max_area) *half.max_area /= 4;
  const Result small = refined(shapes::scaled(mesh, 0.5), half, 1);
  ASSERT_EQ(small.mesh.faces.items(), result.mesh.faces.items());
  for (std::uint32_t v = 0; v < small.mesh.positions.size(); ++v)
    ASSERT_EQ(2 * small.mesh.positions[VertexId(v)], result.mesh.positions[VertexId(v)]);
}

polygons::Polygon random_polygon(Random& random, bool with_holes) {
  const std::uint64_t seed = random.bits();
  switch (random.below(3)) {
    case 0: return polygons::star_with_holes(seed, random.integer(4, 30), with_holes ? 3 : 0);
    case 1: return polygons::grown(seed, random.integer(4, 20), 12);
    default: return polygons::rectilinear_with_holes(seed, random.integer(2, 8));
  }
}

TEST(refined_polyhedra, cubes_cut_by_planes) {
  for (std::uint64_t seed = kSeed; seed < kSeed + 60; ++seed) {
    Random random(seed);
    const PolygonMesh mesh = solids::cut_cube(seed, random.integer(1, 25));
    const Options options = random_options(random, 2);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + words(options));
    expect_refined_well(mesh, options);
  }
}

TEST(refined_polyhedra, extrusions_with_holes_anywhere_in_space) {
  for (std::uint64_t seed = kSeed + 1000; seed < kSeed + 1060; ++seed) {
    Random random(seed);
    const polygons::Polygon polygon = random_polygon(random, true);
    const double scale = std::pow(10, random.integer(-3, 3));
    const PolygonMesh flat = solids::extrusion(polygon, random.uniform(0.1, 2));
    const PolygonMesh mesh = random.chance(0.3) ? flat : solids::placed(flat, polygons::random_placement(seed, scale));
    const Options options = random_options(random, size_of(mesh));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + words(options));
    expect_refined_well(mesh, options);
  }
}

TEST(refined_polyhedra, prisms_written_with_six_decimals) {
  for (std::uint64_t seed = kSeed + 2000; seed < kSeed + 2040; ++seed) {
    Random random(seed);
    const polygons::Polygon polygon = random_polygon(random, false);
    const PolygonMesh turned =
        solids::placed(solids::extrusion(polygon, random.uniform(0.2, 2)), polygons::random_placement(seed, 1));
    const PolygonMesh mesh = shapes::rounded(turned, 1e-6);
    const Options options = random_options(random, size_of(mesh));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + words(options));
    expect_refined_well(mesh, options, 1e-5);
  }
}

TEST(refined_polyhedra, open_regions_with_holes) {
  for (std::uint64_t seed = kSeed + 3000; seed < kSeed + 3040; ++seed) {
    Random random(seed);
    const PolygonMesh mesh = solids::region(random_polygon(random, true));
    const Options options = random_options(random, size_of(mesh));
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + words(options));
    expect_refined_well(mesh, options);
  }
}

TEST(refined_polyhedra, blocks_that_touch_in_edges_and_corners) {
  for (std::uint64_t seed = kSeed + 4000; seed < kSeed + 4040; ++seed) {
    Random random(seed);
    const PolygonMesh mesh =
        shapes::renumbered(shapes::random_blocks(random, 4, seed % 2 == 0 ? 1 : 2), static_cast<unsigned>(seed));
    const Options options = random_options(random, 4);
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + words(options));
    expect_refined_well(mesh, options);
  }
}

TEST(refined_polyhedra, any_soup_of_polygons_comes_back_verified) {
  for (std::uint64_t seed = kSeed + 5000; seed < kSeed + 5150; ++seed) {
    Random random(seed);
    const PolygonMesh mesh = shapes::random_soup(random, 5);
    Options options = random_options(random, 3);
    options.proximity = 0;  // where facets cross, there is no end to how near they come
    SCOPED_TRACE("seed " + std::to_string(seed) + ": " + words(options));
    try {
      const Result result = refined(mesh, options, 2);
      EXPECT_TRUE(result.report.verified.all_true());
      const Bounds bounds = bounds_of(options);
      EXPECT_LE(faces_beyond(result.mesh, bounds, 1e-8).size(), listed(result.report));
      if (!do_sizes_vary(options)) {
        EXPECT_GE(faces_beyond(result.mesh, bounds, -1e-8).size(), listed(result.report));
      }
    } catch (const Error& error) {
      const bool is_shared_diagonal = error.code == Code::kVerificationFailed &&
                                      std::string(error.what()).starts_with("faces on the same vertices");
      const bool is_hopeless =
          error.code == Code::kOutputTooLarge && std::string(error.what()).starts_with("with these sizes");
      EXPECT_TRUE(error.code == Code::kEmptyMesh || is_hopeless || is_shared_diagonal) << error.what();
    }
  }
}

}  // namespace
}  // namespace remesh
