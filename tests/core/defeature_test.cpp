// Tests that details smaller than defeature_size go, within that distance, and that nothing else changes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/geometry/intersections/self_intersections.h"
#include "core/geometry/triangles/distances.h"
#include "core/mesh/adjacency.h"
#include "core/remesh.h"
#include "tests/support/hausdorff.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/refined_checks.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"

namespace remesh {
namespace {

Options without_details(double size, bool refine = true) {
  Options options;
  options.defeature_size = size;
  options.refine = refine;
  return options;
}

std::vector<Corners3> triangles_in_space(const TriangleMesh& mesh) {
  std::vector<Corners3> corners;
  for (const Triangle& t : mesh.faces)
    corners.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
  return corners;
}
std::vector<Corners3> triangles_in_space(const PolygonMesh& mesh) {
  return triangles_in_space(shapes::triangles(shapes::fan_triangulated(mesh)));
}

std::uint64_t removed_count(const Report& report) {
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == DiagnosticCode::kRemovedDetail) return d.count;
  return 0;
}

std::size_t intersection_count(const TriangleMesh& mesh) {
  RunControl control;
  return self_intersections(mesh.positions.items(), mesh.faces.items(), {}, SearchLimits(1000), control).pairs.size();
}

/// Tests what holds for every answer. The distance is measured by brute force.
/// Input: a mesh whose faces are convex.
void expect_sound_without_details(const PolygonMesh& mesh, double size, const Result& result, const std::string& what) {
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true()) << what;
  EXPECT_EQ(report.output.closed, report.input.closed) << what;
  ASSERT_TRUE(report.distance_bound) << what;
  const double bound = std::max(report.distance_bound->output_to_input, report.distance_bound->input_to_output);
  EXPECT_LE(bound, std::max(size, 2 * report.plane_tolerance) * (1 + 1e-9)) << what;
  // For shorter distances, the search takes minutes.
  if (size >= 1e-3) {
    EXPECT_LE(test::hausdorff(triangles_in_space(mesh), triangles_in_space(result.mesh), size / 20),
              bound * (1 + 1e-9) + 1e-14)
        << what;
  }
  EXPECT_EQ(intersection_count(result.mesh), 0u) << what;
}

/// A solid whose outline in the plane of x and z has these corners, one unit deep.
PolygonMesh extruded(const std::vector<Vec2>& outline) { return shapes::prism(outline, 1); }

TEST(defeature, low_steps_go) {
  for (const double step : {1e-3, 1e-4, 1e-6}) {
    const PolygonMesh mesh =
        shapes::fan_triangulated(extruded({{0, 0}, {1, 0}, {1, 1 - step}, {0.5, 1 - step}, {0.5, 1}, {0, 1}}));
    const double size = 2 * step;
    const Result kept = refined(mesh, without_details(0)), gone = refined(mesh, without_details(size));
    EXPECT_EQ(removed_count(kept.report), 0u);
    EXPECT_GT(removed_count(gone.report), 0u) << step;
    expect_sound_without_details(mesh, size, gone, "step of " + std::to_string(step));
    EXPECT_GT(shortest_edge(gone.mesh), size / 3) << step;
    EXPECT_LT(gone.mesh.faces.size(), 200u) << step;
    EXPECT_LT(gone.mesh.faces.size(), kept.mesh.faces.size()) << step;
  }
}

TEST(defeature, the_bound_on_the_volume_covers_rounding_and_what_was_removed) {
  constexpr double kStep = 0.01;
  const PolygonMesh mesh =
      shapes::fan_triangulated(extruded({{0, 0}, {1, 0}, {1, 1 - kStep}, {0.4, 1 - kStep}, {0.4, 1}, {0, 1}}));
  for (const Storage storage : {Storage::kDouble, Storage::kFloat}) {
    RunControl control;
    const Report report = remesh_surface(mesh, without_details(2 * kStep, false), {.storage = storage}, control).report;
    ASSERT_GT(removed_count(report), 0U);
    EXPECT_LE(std::fabs(report.output.volume.value() - report.input.volume.value()), report.volume_bound);
    EXPECT_LE(report.volume_bound, 4 * kStep);
  }
}

TEST(defeature, narrow_facets_go) {
  for (const double width : {1e-3, 1e-5}) {
    const PolygonMesh mesh =
        shapes::fan_triangulated(extruded({{0, 0}, {1, 0}, {1, 1 - width}, {1 - width, 1}, {0, 1}}));
    const double size = 2 * width;
    const Result gone = refined(mesh, without_details(size));
    expect_sound_without_details(mesh, size, gone, "chamfer");
    EXPECT_EQ(gone.report.patches.size(), 6u) << width;
    EXPECT_GT(smallest_angle_deg(gone.mesh), 24.9) << width;
    EXPECT_GT(shortest_edge(gone.mesh), size / 3) << width;
  }
}

TEST(defeature, needles_at_creases_go) {
  for (const double height : {1e-3, 1e-4, 1e-6, 1e-8}) {
    const PolygonMesh mesh = shapes::cube_with_needle(height);
    const double size = 2 * height;
    const Result gone = refined(mesh, without_details(size));
    // Lower ones are no more than rounding explains, so their corners are not essential.
    if (height > 1e-5) {
      EXPECT_GT(removed_count(gone.report), 0u) << height;
    }
    expect_sound_without_details(mesh, size, gone, "needle");
    EXPECT_LT(gone.mesh.faces.size(), 300u) << height;
    EXPECT_GT(shortest_edge(gone.mesh), 0.05) << height;
  }
}

TEST(defeature, flaps_go) {
  for (const bool is_closed : {false, true})
    for (const double height : {1e-3, 1e-5}) {
      const PolygonMesh mesh = shapes::sheet_with_flap(height, is_closed);
      Options options = without_details(2 * height);
      options.repair.duplicates = false;
      const Result gone = refined(mesh, options);
      EXPECT_TRUE(gone.report.verified.all_true());
      EXPECT_GT(removed_count(gone.report), 0u) << height << is_closed;
      EXPECT_EQ(gone.report.output.non_manifold_edges, 0u) << height << is_closed;
      if (height >= 1e-3) {
        EXPECT_LE(test::hausdorff(triangles_in_space(mesh), triangles_in_space(gone.mesh), height / 10), 2 * height);
      }
      EXPECT_LT(gone.mesh.faces.size(), 20u) << height << is_closed;
    }
}

TEST(defeature, a_narrow_sheet_is_no_flap) {
  // A ring that is a thousandth wide has nothing on which its corners would hang.
  const PolygonMesh ring = solids::nested_squares(1, 1e-3);
  const Result result = refined(ring, without_details(2e-3));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_NEAR(result.report.output.area, result.report.input.area, 1e-9 * result.report.input.area);
}

TEST(defeature, deep_slots_and_thin_walls_stay_sound) {
  for (const double width : {1e-3, 1e-4}) {
    const PolygonMesh slot =
        extruded({{0, 0}, {1, 0}, {1, 1}, {0.5 + width, 1}, {0.5 + width, 0.25}, {0.5, 0.25}, {0.5, 1}, {0, 1}});
    // The faces of a prism over this outline are not convex, so they are compared triangle by triangle.
    const Result gone = refined(slot, without_details(2 * width));
    EXPECT_TRUE(gone.report.verified.all_true());
    EXPECT_TRUE(gone.report.output.closed);
    EXPECT_EQ(intersection_count(gone.mesh), 0u);
    const PolygonMesh plate = shapes::box({1, 1, width}, 4);
    const Result thin = refined(plate, without_details(2 * width));
    expect_sound_without_details(plate, 2 * width, thin, "plate");
  }
}

TEST(defeature, nothing_changes_without_details) {
  for (const PolygonMesh& mesh : {shapes::box({1, 2, 3}, 3), shapes::plate_with_round_hole(32), shapes::l_bracket(2),
                                  shapes::cylinder(24, 1, 2)}) {
    const Result kept = refined(mesh, without_details(0)), same = refined(mesh);
    EXPECT_EQ(kept.mesh.faces, same.mesh.faces);
    EXPECT_EQ(kept.mesh.positions, same.mesh.positions);
    EXPECT_EQ(removed_count(same.report), 0u);
  }
}

TEST(defeature, what_rounding_explains_goes_by_default) {
  // Coordinates of floats are known to some 1e-7.
  const PolygonMesh mesh = shapes::rounded(shapes::cube_with_needle(0x1p-33), 0x1p-40);
  const Result result = refined(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_LT(result.mesh.faces.size(), 100u);
}

TEST(defeature, sources_and_patches_are_in_the_numbering_of_the_input) {
  const PolygonMesh mesh = shapes::cube_with_needle(1e-4);
  RunControl control;
  RunSettings settings;
  settings.want_face_source = true;
  const Result result = remesh_surface(mesh, without_details(1e-3), settings, control);
  ASSERT_EQ(result.face_source.size(), result.mesh.faces.size());
  ASSERT_EQ(result.input_face_patch.size(), mesh.face_count());
  std::uint64_t of_patches = 0;
  for (const PatchSummary& patch : result.report.patches) of_patches += patch.input_faces;
  EXPECT_LE(of_patches, mesh.face_count());
  EXPECT_GE(of_patches, mesh.face_count() - 1);
  for (FaceId f(0); f.value < result.face_source.size(); ++f.value)
    EXPECT_LT(result.face_source[f].value, mesh.face_count());
  for (const Diagnostic& d : result.report.diagnostics) {
    if (d.code != DiagnosticCode::kRemovedDetail) continue;
    ASSERT_EQ(d.elements.size(), 1u);
    EXPECT_EQ(d.elements[0], 8u);
  }
}

STAGE(defeature, test::kNumbering) {
  const double step = 1e-3;
  for (const PolygonMesh& mesh :
       {shapes::cube_with_needle(1e-3), shapes::sheet_with_flap(1e-3, false),
        shapes::fan_triangulated(extruded({{0, 0}, {1, 0}, {1, 1 - step}, {0.5, 1 - step}, {0.5, 1}, {0, 1}}))}) {
    const Result result = refined(trial.of(mesh), without_details(2e-3));
    EXPECT_GT(removed_count(result.report), 0u);
    trial.mesh(result.mesh);
  }
}

TEST(defeature, labels_stay) {
  const double width = 1e-3;
  PolygonMesh mesh = extruded({{0, 0}, {1, 0}, {1, 1 - width}, {1 - width, 1}, {0, 1}});
  // The sides of the prism follow its two ends; the third one is the chamfer.
  const std::size_t faces = mesh.face_count();
  const FaceId chamfer(faces - 5 + 2);
  mesh.labels.group.names = {"body", "chamfer"};
  mesh.labels.group.of_face.assign(faces, 0);
  mesh.labels.group.of_face[chamfer] = 1;
  const Result result = refined(mesh, without_details(2 * width));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(removed_count(result.report), 0u);
  const auto& labels = result.mesh.labels.group.of_face.items();
  EXPECT_GT(std::count(labels.begin(), labels.end(), 1u), 0);
  // Without barriers, the chamfer goes.
  Options options = without_details(2 * width);
  options.barriers = {false, false, false};
  EXPECT_GT(removed_count(refined(mesh, options).report), 0u);
}

/// A box of many squares whose vertices are moved at random, the middle ones by more.
TEST(defeature, rough_boxes_stay_sound) {
  Random random(4101);
  for (int i = 0; i < 12; ++i) {
    PolygonMesh mesh = shapes::box({1, 1, 1}, 3);
    const double size = std::pow(10, -1 - random.unit() * 4);
    for (Vec3& p : mesh.positions)
      for (int axis = 0; axis < 3; ++axis) p[axis] += size * (random.unit() - 0.5);
    const Result result = refined(mesh, without_details(size));
    expect_sound_without_details(mesh, size, result, "rough box " + std::to_string(i));
  }
}

TEST(defeature, places_that_local_units_cannot_tell_apart_do_not_make_faces_intersect) {
  // Part of a star-shaped plate. One corner is so far away that the plate is as thin as nothing in the unit of the
  // whole.
  const PolygonMesh plate = shapes::from_lists(
      {{0.8, 0, 0.7},    {0.41, 0, 1.5},   {0.79, 0, 2.3},    {0.01, 0, 2.29},   {1.3, 0, 0.01},    {1.8, 0, 0.7},
       {1.8, 0, 2.3},    {1.31, 0, 3},     {2.2, 0, 1.5},     {0.4, 0.3, 1.5},   {0.01, 0.3, 2.29}, {0.79, 0.3, 2.3},
       {1.8, 0.3, 0.69}, {1.3, 0.3, 0},    {0.21, 0.3, 2.21}, {0.9, 0.3, 2.21},  {0.9, 0.3, 0.79},  {1.3, 0.3, 2.79},
       {1.69, 0.3, 2.2}, {1.69, 0.3, 0.8}, {2.11, 0.3, 1.5},  {2.39, 1e22, 2.21}},
      {{1, 2, 3},    {4, 5, 0},    {2, 6, 7},    {0, 2, 1},   {0, 5, 2},    {5, 8, 2},   {8, 6, 2},
       {1, 3, 9},    {3, 10, 9},   {3, 2, 10},   {2, 11, 10}, {2, 7, 11},   {4, 13, 5},  {5, 13, 12},
       {15, 17, 18}, {20, 18, 21}, {16, 20, 19}, {9, 10, 14}, {10, 11, 14}, {11, 15, 14}});
  Options options;
  options.refine = false;
  const Result result = refined(plate, options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.report.input.intersecting_pairs, 0u);
  EXPECT_EQ(result.report.output.intersecting_pairs, 0u);
}

/// A cube with a part of its own beside it. The part's farthest point is `far` above the middle of the cube's top.
PolygonMesh with_part(const PolygonMesh& part, double far) {
  double top = 0;
  for (const Vec3& p : part.positions) top = std::max(top, p.z);
  return shapes::fan_triangulated(
      shapes::joined(shapes::box({1, 1, 1}), shapes::moved(part, {0.51, 0.52, 1 + far - top})));
}

TEST(defeature, specks_near_the_rest_go) {
  const double size = 0.01;
  const PolygonMesh cube = shapes::box({0.004, 0.004, 0.004}), sheet = shapes::sheet(0.005, 0.005, 1, 1);
  for (const PolygonMesh& part : {cube, sheet})
    for (const double far : {0.006, 0.009}) {
      const PolygonMesh mesh = with_part(part, far);
      const Result result = refined(mesh, without_details(size));
      EXPECT_TRUE(result.report.verified.all_true());
      EXPECT_EQ(removed_count(result.report), 1u) << far;
      EXPECT_EQ(result.report.output.components, 1u) << far;
      EXPECT_TRUE(result.report.output.closed);
      ASSERT_TRUE(result.report.distance_bound);
      EXPECT_LE(result.report.distance_bound->input_to_output, size) << far;
      // The cube has no point nearer to the part's farthest ones than below them.
      EXPECT_GE(result.report.distance_bound->input_to_output, far) << far;
      EXPECT_LE(test::hausdorff(triangles_in_space(mesh), triangles_in_space(result.mesh), size / 20),
                result.report.distance_bound->input_to_output + 1e-12);
      EXPECT_EQ(result.mesh.faces.size(), refined(shapes::box({1, 1, 1}), without_details(size)).mesh.faces.size());
    }
}

TEST(defeature, specks_that_are_far_away_stay_and_are_told) {
  const PolygonMesh mesh = with_part(shapes::box({0.004, 0.004, 0.004}), 0.02);
  const Result result = refined(mesh, without_details(0.012));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(removed_count(result.report), 0u);
  EXPECT_EQ(result.report.output.components, 2u);
  EXPECT_TRUE(std::any_of(result.report.diagnostics.begin(), result.report.diagnostics.end(),
                          [](const Diagnostic& d) { return d.code == DiagnosticCode::kSmallDetail; }));
}

TEST(defeature, parts_that_are_no_specks_stay) {
  // The part's diagonal is 0.0104.
  const PolygonMesh mesh = with_part(shapes::box({0.006, 0.006, 0.006}), 0.009);
  const Result result = refined(mesh, without_details(0.0095));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.report.output.components, 2u);
  // Nothing would be left.
  const Result alone = refined(shapes::box({0.5, 0.5, 0.5}), without_details(1));
  EXPECT_TRUE(alone.report.verified.all_true());
  EXPECT_TRUE(alone.report.output.closed);
  EXPECT_GE(alone.mesh.faces.size(), 4u);
}

TEST(defeature, a_void_that_is_a_speck_is_filled) {
  const PolygonMesh hollow = shapes::turned_over(shapes::box({0.004, 0.004, 0.004}));
  const PolygonMesh mesh = with_part(hollow, -0.002);
  const Result result = refined(mesh, without_details(0.01));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(removed_count(result.report), 1u);
  EXPECT_EQ(result.report.output.components, 1u);
  EXPECT_GE(result.report.volume_bound, 6.4e-8);
}

TEST(defeature, a_speck_with_a_label_of_its_own_stays) {
  PolygonMesh mesh = with_part(shapes::box({0.004, 0.004, 0.004}), 0.006);
  mesh.labels.group.names = {"cube", "speck"};
  for (std::size_t f = 0; f < mesh.face_count(); ++f) mesh.labels.group.of_face.push_back(f < 12 ? 0 : 1);
  const Result result = refined(mesh, without_details(0.01));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.report.output.components, 2u);
}

}  // namespace
}  // namespace remesh
