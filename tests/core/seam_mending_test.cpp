// Seams within the rounding of coordinates, from the mesh as read to the result.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "core/io/mesh_files.h"
#include "core/remesh.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"
#include "tests/support/torn.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

Report remeshed(const PolygonMesh& mesh, const Options& options = unrefined()) {
  RunControl control;
  return remesh_surface(mesh, options, {}, control).report;
}

std::uint64_t seams_of(const Report& report) {
  std::uint64_t count = 0;
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kSeam) count += d.count;
  return count;
}

/// A closed cylinder whose last angle is a full turn as computed, so that its sine is not 0. On its outside it has
/// `before` rows of quads along the seam up to the last column, and `after` rows in the first one.
PolygonMesh cylinder_with_a_seam(std::uint32_t sides, std::uint32_t before, std::uint32_t after) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto at = [&](std::uint32_t i, double z) {
    const double angle = 2 * std::numbers::pi * i / sides;
    points.push_back({25 * std::cos(angle), 25 * std::sin(angle), z});
    return static_cast<std::uint32_t>(points.size() - 1);
  };
  for (std::uint32_t i = 0; i < sides; ++i) {
    const bool is_first = i == 0, is_last = i + 1 == sides;
    const std::uint32_t left = is_first ? after : 1, right = is_last ? before : 1;
    std::vector<std::uint32_t> wall;
    for (std::uint32_t k = 0; k <= right; ++k) wall.push_back(at(i + 1, 120.0 * k / right));
    for (std::uint32_t k = left + 1; k-- > 0;) wall.push_back(at(i, 120.0 * k / left));
    faces.push_back(wall);
    points.insert(points.end(), {{0, 0, 0}, {0, 0, 120}});
    const auto middle = static_cast<std::uint32_t>(points.size() - 2);
    const std::uint32_t low = at(i, 0), next_low = at(i + 1, 0), high = at(i, 120), next_high = at(i + 1, 120);
    faces.push_back({middle, next_low, low});
    faces.push_back({middle + 1, high, next_high});
  }
  return shapes::from_lists(points, faces);
}

TEST(seams, a_cylinder_whose_full_turn_misses_its_beginning_by_rounding_is_closed) {
  const Report report = remeshed(cylinder_with_a_seam(12, 1, 1));
  EXPECT_FALSE(report.input.closed);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
  // The wall's seam, and on both caps the spoke to it.
  EXPECT_EQ(seams_of(report), 3u);
  const double area = 12 * 25 * 25 * std::sin(2 * std::numbers::pi / 12) / 2;
  EXPECT_NEAR(report.output.volume.value_or(0), 120 * area, 1e-6);
}

TEST(seams, sides_that_are_subdivided_differently_close) {
  for (const auto& [before, after] : {std::pair{1u, 4u}, {3u, 1u}, {3u, 4u}, {4u, 4u}}) {
    const Report report = remeshed(cylinder_with_a_seam(12, before, after));
    EXPECT_TRUE(report.output.closed) << before << " " << after;
    EXPECT_TRUE(report.verified.all_true()) << before << " " << after;
  }
}

TEST(seams, they_are_left_open_if_they_are_not_to_be_mended) {
  Options options = unrefined();
  options.repair.seams = false;
  const Report report = remeshed(cylinder_with_a_seam(12, 1, 1), options);
  EXPECT_FALSE(report.output.closed);
  EXPECT_EQ(seams_of(report), 3u);
}

TEST(seams, groups_do_not_keep_a_seam_open) {
  PolygonMesh mesh = cylinder_with_a_seam(12, 1, 1);
  mesh.labels.group.names = {"first", "last"};
  for (std::uint32_t f = 0; f < mesh.face_count(); ++f) mesh.labels.group.of_face.push_back(f < 18 ? 0 : 1);
  const Report report = remeshed(mesh);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
}

TEST(seams, a_tolerance_below_what_rounding_explains_holds_for_seams_as_well) {
  Options options = unrefined();
  options.plane_tolerance = 1e-15;
  EXPECT_FALSE(remeshed(cylinder_with_a_seam(12, 1, 1), options).output.closed);
}

TEST(seams, refined_results_are_closed_and_verified) {
  Options options;
  options.max_edge_length = 20;
  const Report report = remeshed(cylinder_with_a_seam(12, 3, 4), options);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
}

TEST(seams, a_solid_of_facets_that_were_all_moved_by_rounding_is_closed) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const PolygonMesh mesh = torn::into_facets(shapes::box({1, 2, 3}, 3), torn::noise(seed, 1e-15));
    const Report report = remeshed(mesh);
    EXPECT_TRUE(report.output.closed);
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_EQ(report.output.faces, 12u);
    EXPECT_NEAR(report.output.volume.value_or(0), 6, 1e-12);
  }
}

TEST(seams, the_cylinder_of_the_shared_collection_is_closed) {
  const std::filesystem::path path = test::shared_meshes_folder() / "reports" / "cylinder-seam.stl";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "the shared collection of meshes is not there";
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  const Report report = remeshed(read_mesh(Format::kStl, text, {}, control).mesh);
  EXPECT_FALSE(report.input.closed);
  EXPECT_TRUE(report.output.closed);
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_GT(seams_of(report), 0u);
}

}  // namespace
}  // namespace remesh
