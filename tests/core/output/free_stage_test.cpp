#include "core/output/run/free_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/io/mesh_files.h"
#include "tests/support/free_shapes.h"
#include "tests/support/hausdorff.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/shared_meshes.h"

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

double min_angle_deg(const Corners3& t) {
  double least = 180;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 p = t[(i + 1) % 3] - t[i], q = t[(i + 2) % 3] - t[i];
    least = std::min(least, std::atan2(norm(cross(p, q)), dot(p, q)) * 180 / 3.14159265358979323846);
  }
  return least;
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
  Options none_by_turn = within(0);
  none_by_turn.elements_per_circle = 16;
  for (const Options& options : {Options(), within(0), none_by_turn}) {
    const Result result = remeshed(mesh, options);
    EXPECT_FALSE(is_told_coarser(result));
    EXPECT_GE(result.mesh.faces.size(), mesh.face_count());
  }
  Options rigid = within(3e-3);
  rigid.keep_boundary_vertices = true;
  EXPECT_FALSE(is_told_coarser(remeshed(mesh, rigid)));
}

/// A finer surface that is exact to the last bits has nothing coarser within a tolerance of its rounding.
TEST(free_stage, the_reason_why_facets_stay_is_told) {
  const PolygonMesh mesh = bumpy_ball(3);
  const Result result = remeshed(mesh, within(1e-9));
  EXPECT_FALSE(is_told_coarser(result));
  const auto is_reason = [](const Diagnostic& d) {
    return d.code == DiagnosticCode::kCurvedSurface && d.message.find("need no fewer triangles") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(result.report.diagnostics.begin(), result.report.diagnostics.end(), is_reason));
}

/// Returns the height of the formula's surface over the middle of most edges of a bumpy ball, as tolerance_of means
/// "most".
double chord_height(const PolygonMesh& ball) {
  std::vector<double> heights;
  for (FaceId f(0); f.value < ball.face_count(); ++f.value) {
    const auto corners = ball.face(f);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 middle = 0.5 * (ball.positions[corners[k]] + ball.positions[corners[(k + 1) % 3]]);
      heights.push_back(std::fabs(norm(middle) - bumpy_radius(normalized(middle))));
    }
  }
  std::sort(heights.begin(), heights.end());
  return heights[heights.size() * 9 / 10];
}

double largest_bound(const Result& result) {
  return std::max(result.report.distance_bound->output_to_input, result.report.distance_bound->input_to_output);
}

Options by_turn(double elements_per_circle) {
  Options options;
  options.elements_per_circle = elements_per_circle;
  return options;
}

/// Returns the angles by which neighbours turn, ascending, in degrees.
std::vector<double> turns_of(const TriangleMesh& mesh) {
  std::map<std::pair<VertexId, VertexId>, Vec3> normals;
  std::vector<double> turns;
  for (const Triangle& t : mesh.faces) {
    const Vec3 normal =
        normalized(cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]));
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = t[k], w = t[(k + 1) % 3];
      const auto [found, is_new] = normals.emplace(std::minmax(v, w), normal);
      if (!is_new) turns.push_back(std::acos(std::clamp(dot(found->second, normal), -1.0, 1.0)) * 180 / M_PI);
    }
  }
  std::sort(turns.begin(), turns.end());
  return turns;
}

/// Without a tolerance, a number of elements decides by the radius at each place: a small ball is as good as a large
/// one, and gets as many faces.
TEST(free_stage, a_number_of_elements_counts_by_the_radius_at_each_place) {
  PolygonMesh small = bumpy_ball(5);
  for (Vec3& p : small.positions) p = 0.1 * p + Vec3{1.5, 0, 0};
  const PolygonMesh both = shapes::joined(bumpy_ball(5), small);
  std::vector<Corners3> cap;  // a part is enough to see how far the small ball is off
  for (const Corners3& t : corners_of(shapes::as_triangles(small)))
    if (t[0].z > 0.06) cap.push_back(t);
  ASSERT_GT(cap.size(), 500u);
  std::vector<double> faces;
  for (const double elements : {16.0, 32.0}) {
    const Result result = remeshed(both, by_turn(elements));
    ASSERT_TRUE(is_told_coarser(result));
    EXPECT_TRUE(result.report.verified.all_true());
    std::vector<Corners3> large, little;
    for (const Corners3& t : corners_of(result.mesh)) (t[0].x < 1.2 ? large : little).push_back(t);
    EXPECT_GT(little.size(), 0.7 * static_cast<double>(large.size())) << elements;
    EXPECT_LT(little.size(), 1.4 * static_cast<double>(large.size())) << elements;
    const double far = test::hausdorff_one_way(cap, little, 1e-4);
    EXPECT_LT(far, largest_bound(result) / 5) << elements;
    // Triangles of half an element and more turn by no more than elements may in the median.
    const std::vector<double> turns = turns_of(result.mesh);
    EXPECT_LT(turns[turns.size() / 2], 360 / elements) << elements;
    EXPECT_GT(turns[turns.size() / 2], 360 / elements / 6) << "far more faces than were asked for";
    faces.push_back(static_cast<double>(result.mesh.faces.size()));
  }
  // Twice as many elements in each direction.
  EXPECT_GT(faces[1], 2.5 * faces[0]);
  EXPECT_LT(faces[1], 5 * faces[0]);
}

TEST(free_stage, the_numbering_of_the_input_does_not_count) {
  const PolygonMesh ball = bumpy_ball(4);
  std::vector<Corners3> one = corners_of(remeshed(ball, by_turn(16)).mesh);
  std::vector<Corners3> other = corners_of(remeshed(shapes::renumbered(ball, 5), by_turn(16)).mesh);
  for (std::vector<Corners3>* triangles : {&one, &other}) {
    for (Corners3& t : *triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
    std::sort(triangles->begin(), triangles->end());
  }
  EXPECT_EQ(one, other);
}

TEST(free_stage, of_a_tolerance_and_a_number_of_elements_the_smaller_distance_counts) {
  const PolygonMesh ball = bumpy_ball(5);
  Options both = within(1e-3);
  both.elements_per_circle = 16;
  const Result near = remeshed(ball, both);
  EXPECT_LE(largest_bound(near), 1e-3 * diagonal_of(ball) + near.report.plane_tolerance);
  const double alone = static_cast<double>(remeshed(ball, within(1e-3)).mesh.faces.size());
  EXPECT_GE(static_cast<double>(near.mesh.faces.size()), 0.98 * alone);
  both = within(0.05);
  both.elements_per_circle = 48;
  const double turned = static_cast<double>(remeshed(ball, by_turn(48)).mesh.faces.size());
  EXPECT_GE(static_cast<double>(remeshed(ball, both).mesh.faces.size()), 0.95 * turned);
}

/// With a large number, the facets' own distance from what they stand for counts, and noise counts twice.
TEST(free_stage, a_large_number_of_elements_allows_what_the_facets_themselves_are_off) {
  const PolygonMesh ball = bumpy_ball(5);
  const Options options = by_turn(1000);
  const Result result = remeshed(ball, options);
  EXPECT_TRUE(is_told_coarser(result));
  EXPECT_LT(result.mesh.faces.size(), ball.face_count());
  EXPECT_GT(largest_bound(result), chord_height(ball) / 2);
  EXPECT_LT(largest_bound(result), chord_height(ball) * 2);
  PolygonMesh noisy = ball;
  Random random(7);
  const double sigma = 4e-4;
  for (Vec3& p : noisy.positions) {
    double sum = 0;
    for (int i = 0; i < 12; ++i) sum += random.uniform(-0.5, 0.5);
    p = p + sigma * sum * normalized(p);
  }
  const double allowed = largest_bound(remeshed(noisy, options));
  EXPECT_GT(allowed, sigma);
  EXPECT_LT(allowed, 4 * sigma);
}

/// Returns the volume inside a closed surface.
double volume_of(const std::vector<Corners3>& triangles) {
  double sum = 0;
  for (const Corners3& t : triangles) sum += dot(t[0], cross(t[1], t[2])) / 6;
  return sum;
}

TEST(free_stage, the_volume_is_kept_where_that_is_asked_for) {
  const PolygonMesh ball = bumpy_ball(4);
  const double before = volume_of(corners_of(shapes::as_triangles(ball)));
  Options options = by_turn(12);
  const Result plain = remeshed(ball, options);
  options.circle_fit = CircleFit::kVolume;
  const Result kept = remeshed(ball, options);
  ASSERT_TRUE(is_told_coarser(kept));
  EXPECT_TRUE(kept.report.verified.all_true());
  EXPECT_GT(std::fabs(volume_of(corners_of(plain.mesh)) - before), 1e-5 * before) << "nothing to mend";
  EXPECT_NEAR(volume_of(corners_of(kept.mesh)), before, 1e-12 * before);
  // A sheet with an outline has no volume to keep.
  Options open = by_turn(12);
  const Result sheet = remeshed(hills(48), open);
  ASSERT_TRUE(is_told_coarser(sheet));
  open.circle_fit = CircleFit::kVolume;
  EXPECT_EQ(remeshed(hills(48), open).mesh.positions.items(), sheet.mesh.positions.items());
}

/// Returns the triangles of the result whose corners are all in a plane across an axis.
std::size_t triangles_in_plane(const TriangleMesh& mesh, int axis, double at) {
  return static_cast<std::size_t>(std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](VertexId v) { return mesh.positions[v][axis] == at; });
  }));
}

/// Returns the triangles that lie on no side of the box but the upper one.
std::vector<Corners3> upper_faces(const TriangleMesh& mesh, const Box3& box) {
  std::vector<Corners3> upper;
  for (const Corners3& t : corners_of(mesh)) {
    bool is_on_side = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const double at : {box.min[axis], box.max[axis]})
        is_on_side =
            is_on_side || (!(axis == 2 && at == box.max.z) && t[0][axis] == at && t[1][axis] == at && t[2][axis] == at);
    if (!is_on_side) upper.push_back(t);
  }
  return upper;
}

TEST(free_stage, planes_beside_a_free_surface_keep_their_planes) {
  const PolygonMesh mesh = relief(20);
  const double tolerance = 1e-3 * diagonal_of(mesh);
  Options options = within(1e-3);
  for (const bool refine : {false, true}) {
    options.refine = refine;
    options.defeature_size.reset();
    const Result result = remeshed(mesh, options);
    // Nothing is triangulated then before the stage.
    options.defeature_size = 0;
    EXPECT_EQ(remeshed(mesh, options).mesh.faces, result.mesh.faces);
    const Report& report = result.report;
    EXPECT_TRUE(report.verified.all_true());
    EXPECT_TRUE(is_told_coarser(result));
    EXPECT_LT(result.mesh.faces.size(), mesh.face_count() / 4);
    EXPECT_EQ(report.output.euler, 2);
    EXPECT_TRUE(report.output.closed);
    Box3 box;
    for (const Vec3& p : mesh.positions) box.add(p);
    // Four sides and the bottom; each vertex that is left there is exactly in its plane.
    for (const int axis : {0, 1}) {
      EXPECT_GT(triangles_in_plane(result.mesh, axis, box.min[axis]), 0u);
      EXPECT_GT(triangles_in_plane(result.mesh, axis, box.max[axis]), 0u);
    }
    EXPECT_GT(triangles_in_plane(result.mesh, 2, box.min.z), 0u);
    for (const RecognisedSurface& surface : report.surfaces.surfaces)
      EXPECT_LE(surface.bound, tolerance + report.plane_tolerance);
    const double bound = std::max(report.distance_bound->output_to_input, report.distance_bound->input_to_output);
    EXPECT_LE(bound, tolerance + report.plane_tolerance);
    // New vertices of refinement are in the planes up to rounding.
    if (refine) continue;
    EXPECT_LE(
        test::hausdorff(upper_faces(shapes::triangles(mesh), box), upper_faces(result.mesh, box), 0.2 * tolerance),
        tolerance * (1 + 1e-9));
  }
}

TEST(free_stage, planes_beside_a_free_surface_lose_no_faces_where_that_is_split_again) {
  if (!test::has_shared_mesh("broken/conrod.stl")) return;
  std::ifstream file(test::shared_meshes_folder() / "broken/conrod.stl", std::ios::binary);
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  RunControl control;
  const PolygonMesh mesh = read_mesh(Format::kStl, content, ReadLimits{}, control).mesh;
  Options options = within(1e-2);
  options.refine = false;
  const Result coarser = remeshed(mesh, options);
  EXPECT_TRUE(is_told_coarser(coarser));
  options.surface_tolerance_fraction = 0;
  const Result facets = remeshed(mesh, options);
  EXPECT_EQ(coarser.report.output.euler, facets.report.output.euler);
  EXPECT_EQ(coarser.report.output.boundary_edges, facets.report.output.boundary_edges);
}

/// CAD programs make needles where a surface is straight in one direction.
TEST(free_stage, needles_side_by_side_become_good_triangles_and_planes_beside_them_stay) {
  const PolygonMesh mesh = hills_with_needles(32);
  Options options = within(5e-4);
  options.refine = false;
  const Result result = remeshed(mesh, options);
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_TRUE(is_told_coarser(result));
  const VertexId corner(mesh.positions.size() - 4);  // of the parallelogram
  const Vec3 side{2.2, 0, mesh.positions[VertexId(corner.value + 1)].z - mesh.positions[corner].z};
  const Vec3 normal = cross(side, Vec3{0, 0.4, 0.12});
  double flat_area = 0, wide_area = 0, area_of_needles = 0, narrow_area = 0;
  for (const Corners3& t : corners_of(result.mesh)) {
    const double area = norm(cross(t[1] - t[0], t[2] - t[0])) / 2;
    const auto is_in_plane = [&](const Vec3& p) {
      return std::fabs(dot(p - mesh.positions[corner], normal)) <= 1e-15 * norm(normal);
    };
    if (std::min({t[0].y, t[1].y, t[2].y}) >= 0.8 - 1e-12) {
      wide_area += std::all_of(t.begin(), t.end(), is_in_plane) ? area : 0;
    } else if ((t[0].x + t[1].x + t[2].x) / 3 > 0.8) {
      area_of_needles += area;
      narrow_area += min_angle_deg(t) < 10 ? area : 0;
    }
    if (std::max({t[0].x, t[1].x, t[2].x}) <= -0.8 && t[0].z == 0 && t[1].z == 0 && t[2].z == 0) flat_area += area;
  }
  EXPECT_NEAR(flat_area, 2.2 * 0.05, 1e-9) << "the rectangle has lost its plane";
  EXPECT_NEAR(wide_area, norm(normal), 1e-9) << "the parallelogram has lost its plane";
  EXPECT_LT(narrow_area, 0.2 * area_of_needles) << "it was all of it";
  const double bound = std::max(report.distance_bound->output_to_input, report.distance_bound->input_to_output);
  EXPECT_LE(bound, 5e-4 * diagonal_of(mesh) + report.plane_tolerance);
  EXPECT_LE(test::hausdorff(corners_of(shapes::as_triangles(mesh)), corners_of(result.mesh), 0.5 * bound), bound);
}

/// Long strips would become thousands of triangles. Few coarse ones with angles of 10 degrees and more are better.
TEST(free_stage, strips_of_an_extruded_spline_become_few_triangles) {
  std::vector<Vec2> outline{{0, -1}, {4, -1}};
  for (int i = 120; i >= 0; --i) {
    const double t = i / 120.0;
    outline.push_back({4 * t, 1 + 0.6 * t * t * std::sin(3.1 * t + 0.4) + 0.35 * std::sin(6.8 * t)});
  }
  const PolygonMesh mesh = shapes::prism(outline, 1);
  Options options = within(2e-3);
  const Result result = remeshed(mesh, options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(is_told_coarser(result));
  EXPECT_LE(result.mesh.faces.size(), 400u);  // 3,056 with the strips
  for (const Corners3& t : corners_of(result.mesh)) EXPECT_GE(min_angle_deg(t), 10);
  options.surface_tolerance_fraction = 0;
  options.refine = false;
  const Result facets = remeshed(mesh, options);
  const double tolerance = 2e-3 * diagonal_of(mesh);
  EXPECT_LE(test::hausdorff(corners_of(facets.mesh), corners_of(result.mesh), 0.2 * tolerance), tolerance);
}

TEST(free_stage, curved_surfaces_beside_a_free_one_are_remeshed_as_before) {
  const PolygonMesh mesh = wavy_boss(48);
  const Result result = remeshed(mesh, within(4e-3));
  const Report& report = result.report;
  EXPECT_TRUE(report.verified.all_true());
  EXPECT_TRUE(is_told_coarser(result));
  const auto& surfaces = report.surfaces.surfaces;
  EXPECT_TRUE(std::any_of(surfaces.begin(), surfaces.end(), [](const RecognisedSurface& s) {
    return s.shape.kind == SurfaceKind::kCylinder && s.is_remeshed;
  }));
  const double bound = std::max(report.distance_bound->output_to_input, report.distance_bound->input_to_output);
  EXPECT_LE(bound, 4e-3 * diagonal_of(mesh) + report.plane_tolerance);
}

TEST(free_stage, faces_with_other_labels_stay_apart) {
  PolygonMesh mesh = bumpy_ball(4);
  mesh.labels.material.names = {"left", "right"};
  for (FaceId f(0); f.value < mesh.face_count(); ++f.value) {
    Vec3 sum;
    for (const VertexId v : mesh.face(f)) sum += mesh.positions[v];
    mesh.labels.material.of_face.push_back(sum.x > 0 ? 1 : 0);
  }
  const double tolerance = 2e-3 * diagonal_of(mesh);
  const Result result = remeshed(mesh, within(2e-3));
  EXPECT_TRUE(is_told_coarser(result));
  EXPECT_LT(result.mesh.faces.size(), mesh.face_count() / 2);
  // Each label covers what it covered, within the tolerance.
  for (const std::uint32_t label : {0u, 1u}) {
    std::vector<Corners3> before, now;
    const auto before_all = corners_of(shapes::as_triangles(mesh)), now_all = corners_of(result.mesh);
    for (FaceId f(0); f.value < before_all.size(); ++f.value)
      if (mesh.labels.material.of_face[f] == label) before.push_back(before_all[f.value]);
    for (FaceId f(0); f.value < now_all.size(); ++f.value)
      if (result.mesh.labels.material.of_face[f] == label) now.push_back(now_all[f.value]);
    ASSERT_FALSE(now.empty());
    EXPECT_LE(test::hausdorff(before, now, 0.05 * tolerance), tolerance * (1 + 1e-9));
  }
}

TEST(free_stage, a_surface_becomes_coarser_only_after_its_faces_were_cut_where_they_cross) {
  // The strip's patch cannot be triangulated at first, and the cuts wait until it is divided.
  const PolygonMesh mesh = shapes::joined(shapes::strip_over_itself(), shapes::moved(bumpy_ball(3), {5, 0, 0}));
  Options options = within(1e-2);
  options.repair.self_intersections = true;
  const Result result = remeshed(mesh, options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(result.report.solids);
  EXPECT_TRUE(is_told_coarser(result));
  EXPECT_LT(result.mesh.faces.size(), mesh.face_count() / 2);
}

TEST(free_stage, a_surface_becomes_coarser_beside_a_patch_that_fails_at_first) {
  const PolygonMesh mesh = shapes::joined(shapes::strip_over_itself(), shapes::moved(bumpy_ball(3), {5, 0, 0}));
  const Result result = remeshed(mesh, within(1e-2));
  EXPECT_TRUE(is_told_coarser(result));
  RunControl control;
  EXPECT_EQ(analyze_surface(mesh, within(1e-2), {}, control).predicted_faces, result.mesh.faces.size());
}

TEST(free_stage, parts_without_free_faces_are_left_to_other_stages) {
  for (const PolygonMesh& mesh : {shapes::cylinder(48, 1, 2), shapes::box({1, 2, 3}, 4), shapes::sphere(3)}) {
    const Result result = remeshed(mesh, within(3e-3));
    EXPECT_FALSE(is_told_coarser(result));
    EXPECT_TRUE(result.report.verified.all_true());
  }
}

}  // namespace
}  // namespace remesh
