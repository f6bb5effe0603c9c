#include "core/output/run/free_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/free_shapes.h"
#include "tests/support/hausdorff.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

Options within(double tolerance_fraction) {
  Options options;
  options.surface_tolerance_fraction = tolerance_fraction;
  return options;
}

double diagonal_of(const PolygonMesh& mesh) {
  Box3 box;
  for (const Vec3& p : mesh.positions) box.add(p);
  return box.diagonal();
}

std::vector<Corners3> corners_of(const TriangleMesh& mesh) {
  std::vector<Corners3> corners;
  for (const Triangle& t : mesh.faces)
    corners.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  return corners;
}

bool is_told_coarser(const Result& result) {
  return std::any_of(result.report.diagnostics.begin(), result.report.diagnostics.end(), [](const Diagnostic& d) {
    return d.code == DiagnosticCode::kCurvedSurface && d.message.find("made it coarser") != std::string::npos;
  });
}

TEST(free_stage, a_surface_of_no_kind_becomes_coarser_within_the_tolerance) {
  for (const PolygonMesh& mesh : {bumpy_ball(4), hills(48)}) {
    const double tolerance = 2e-3 * diagonal_of(mesh);
    const Result result = remeshed(mesh, within(2e-3));
    const Report& report = result.report;
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_LT(result.mesh.faces.size(), mesh.face_count() / 2);
    EXPECT_GE(report.output.quality.min_angle_deg, 24.9);
    EXPECT_EQ(report.output.euler, report.input.euler);
    EXPECT_EQ(report.output.closed, report.input.closed);
    EXPECT_EQ(report.output.components, 1u);
    EXPECT_TRUE(is_told_coarser(result));
    const double bound = std::max(report.distance_bound->output_to_input, report.distance_bound->input_to_output);
    EXPECT_LE(bound, tolerance + report.plane_tolerance);
    const double measured =
        test::hausdorff(corners_of(shapes::as_triangles(mesh)), corners_of(result.mesh), 0.05 * tolerance);
    EXPECT_LE(measured, bound);
    EXPECT_GE(measured, 0.5 * bound) << "the bound says little";
  }
}

TEST(free_stage, the_result_is_the_same_for_any_number_of_workers) {
  RunSettings two;
  two.workers = 2;
  const Result one = remeshed(bumpy_ball(4), within(2e-3)), other = remeshed(bumpy_ball(4), within(2e-3), two);
  EXPECT_EQ(one.mesh.positions.items(), other.mesh.positions.items());
  EXPECT_EQ(one.mesh.faces.items(), other.mesh.faces.items());
}

TEST(free_stage, every_input_face_has_a_patch_and_every_output_face_a_source) {
  const PolygonMesh mesh = bumpy_ball(3);
  RunSettings settings;
  settings.want_face_source = true;
  const Result result = remeshed(mesh, within(3e-3), settings);
  ASSERT_TRUE(is_told_coarser(result));
  ASSERT_EQ(result.face_source.size(), result.mesh.faces.size());
  for (const FaceId f : result.face_source) EXPECT_LT(f.value, mesh.face_count());
  ASSERT_EQ(result.input_face_patch.size(), mesh.face_count());
  for (const PatchId p : result.input_face_patch) EXPECT_TRUE(p.is_valid());
}

TEST(free_stage, facets_stay_where_nobody_allows_a_distance) {
  const PolygonMesh mesh = bumpy_ball(3);
  Options by_turn;
  by_turn.elements_per_circle = 16;
  for (const Options& options : {Options(), within(0), by_turn}) {
    const Result result = remeshed(mesh, options);
    EXPECT_FALSE(is_told_coarser(result));
    EXPECT_GE(result.mesh.faces.size(), mesh.face_count());
  }
  Options rigid = within(3e-3);
  rigid.keep_boundary_vertices = true;
  EXPECT_FALSE(is_told_coarser(remeshed(mesh, rigid)));
}

TEST(free_stage, parts_with_planes_or_curved_surfaces_are_left_to_other_stages) {
  for (const PolygonMesh& mesh : {shapes::cylinder(48, 1, 2), shapes::box({1, 2, 3}, 4), shapes::sphere(3)}) {
    const Result result = remeshed(mesh, within(3e-3));
    EXPECT_FALSE(is_told_coarser(result));
    EXPECT_TRUE(result.report.verified.all_true());
  }
}

}  // namespace
}  // namespace remesh
