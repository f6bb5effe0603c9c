#include "core/remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>
#include <sstream>
#include <string>

#include "core/io/obj/obj.h"
#include "tests/support/errors.h"
#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/remeshed.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/time_limit.h"
#include "tests/support/time_to_stop.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

using test::error_of;

/// Returns everything, as text, that a caller sees and that must not depend on the number of workers or on luck.
std::string all_bytes(const Result& result) {
  RunControl control;
  std::ostringstream out;
  out.precision(17);
  out << write_obj(result.mesh, {}, control);
  for (const PatchId p : result.face_patch) out << p << ' ';
  for (const FaceId f : result.face_source) out << f << ' ';
  const auto statistics = [&](const MeshStatistics& s) {
    out << '\n'
        << s.vertices << ' ' << s.faces << ' ' << s.components << ' ' << s.boundary_edges << ' ' << s.non_manifold_edges
        << ' ' << s.closed << ' ' << s.euler << ' ' << s.area << ' ' << s.volume.value_or(-1) << ' '
        << s.quality.min_angle_deg << ' ' << s.quality.max_angle_deg << ' ' << s.quality.aspect_ratio.mean << ' '
        << s.quality.edge_length.mean << ' ' << s.quality.radius_edge_ratio.mean;
    for (const std::uint64_t count : s.quality.angle_histogram_deg.counts) out << ' ' << count;
  };
  statistics(result.report.input);
  statistics(result.report.output);
  out << '\n'
      << result.report.plane_tolerance << ' ' << result.report.rounding_step << ' ' << result.report.volume_bound << ' '
      << result.report.verified.deviation;
  for (const PatchSummary& p : result.report.patches)
    out << '\n'
        << p.normal.x << ' ' << p.normal.y << ' ' << p.normal.z << ' ' << p.offset << ' ' << p.area << ' '
        << p.input_faces << ' ' << p.output_faces << ' ' << p.loops << ' ' << p.essential_vertices << ' '
        << status_name(p.status) << reason_name(p.reason) << ' ' << p.deviation;
  for (const VolumeObstacle& o : result.report.volume_obstacles) {
    out << '\n' << diagnostic_name(o.code) << ' ' << o.count;
    for (const Vec3& place : o.places) out << ' ' << place.x << ' ' << place.y << ' ' << place.z;
  }
  for (const Diagnostic& d : result.report.diagnostics) {
    out << '\n' << diagnostic_name(d.code) << ' ' << d.count << ' ' << d.message;
    for (const std::uint64_t e : d.elements) out << ' ' << e;
  }
  return out.str();
}

bool has_vertex(const Result& result, const Vec3& p) {
  return std::find(result.mesh.positions.begin(), result.mesh.positions.end(), p) != result.mesh.positions.end();
}

void expect_sound(const Result& result) {
  EXPECT_TRUE(result.report.verified.surface);
  EXPECT_TRUE(result.report.verified.conforming);
  EXPECT_TRUE(result.report.verified.delaunay);
  EXPECT_EQ(result.report.output.closed, result.report.input.closed);
  EXPECT_EQ(result.report.output.euler, result.report.input.euler);
  ASSERT_EQ(result.face_patch.size(), result.mesh.faces.size());
  std::vector<std::uint64_t> faces(result.report.patches.size());
  for (const PatchId p : result.face_patch) ++faces[p.value];
  for (std::size_t p = 0; p < faces.size(); ++p) EXPECT_EQ(faces[p], result.report.patches[p].output_faces);
}

/// Makes a part with several kinds of patches. It is a plate with a hole that stands on legs.
PolygonMesh bracket() { return shapes::blocks({"####", "#..#", "####", "#..#"}, 3); }

TEST(remesh_surface, the_volume_changes_by_no_more_than_the_bound_that_is_reported) {
  // All of the top but its rim lies higher: the patch's plane is between the two, and what is taken away is nearly all
  // that lies above the rim.
  const double raised = 1e-3;
  PolygonMesh mesh = shapes::box({1, 1, 1}, 20);
  for (Vec3& p : mesh.positions)
    if (p.z == 1 && std::min(p.x, p.y) > 0 && std::max(p.x, p.y) < 1) p.z += raised;
  Options options = unrefined();
  options.plane_tolerance = 1.5 * raised;
  const Report report = remeshed(mesh, options).report;
  ASSERT_EQ(report.patches.size(), 6u);
  const double change = *report.output.volume - *report.input.volume;
  EXPECT_LT(change, -0.9 * raised);
  EXPECT_LE(std::fabs(change), report.volume_bound);
  EXPECT_LT(report.volume_bound, 1.01 * raised);
}

TEST(remesh_surface, a_polygon_without_a_plane_changes_no_measure_by_becoming_triangles) {
  PolygonMesh mesh = shapes::box({1, 1, 1});
  for (Vec3& p : mesh.positions)
    if (p == Vec3{1, 1, 1}) p.z = 1.5;
  const Report report = remeshed(mesh, unrefined()).report;
  EXPECT_NEAR(report.output.area, report.input.area, 1e-14);
  EXPECT_LE(std::fabs(*report.output.volume - *report.input.volume), report.volume_bound);
  EXPECT_LT(report.volume_bound, 1e-12);
}

TEST(remesh_surface, a_thin_frame_turned_and_rounded_is_one_patch) {
  // Its planes are a thousand wide and its faces ten: one face's plane is wrong at the far end by a hundred steps.
  for (const double width : {3.0, 10.0, 100.0}) {
    const double a = 500, b = 500 - width;
    const PolygonMesh frame = shapes::from_lists(
        {{-a, -a, 0}, {a, -a, 0}, {a, a, 0}, {-a, a, 0}, {-b, -b, 0}, {b, -b, 0}, {b, b, 0}, {-b, b, 0}},
        {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}});
    for (int turn = 1; turn <= 10; ++turn) {
      const Result result = remeshed(shapes::rounded(shapes::rotated(frame, {1, 2, 3}, 33.0 * turn), 1e-6));
      EXPECT_EQ(result.report.patches.size(), 1u) << width << " wide, turn " << turn;
      EXPECT_EQ(result.mesh.faces.size(), 8u);
    }
  }
}

TEST(remesh_surface, the_listing_of_section_1_1_gives_eight_triangles) {
  for (const int cuts : {1, 4}) {
    const Result result = remeshed(shapes::ring(cuts));
    expect_sound(result);
    ASSERT_EQ(result.report.patches.size(), 1u);
    EXPECT_EQ(result.report.patches[0].loops, 2u);
    EXPECT_EQ(result.report.patches[0].essential_vertices, 8u);
    EXPECT_EQ(result.mesh.positions.size(), 8u);
    EXPECT_EQ(result.mesh.faces.size(), 8u);
    EXPECT_EQ(result.report.output.area, 28);
  }
}

TEST(remesh_surface, a_square_of_many_faces_is_two_triangles) {
  const Result result = remeshed(shapes::sheet(2, 2, 18, 19));
  expect_sound(result);
  EXPECT_EQ(result.mesh.positions.size(), 4u);
  EXPECT_EQ(result.mesh.faces.size(), 2u);
}

TEST(remesh_surface, an_l_keeps_its_area) {
  const Result result = remeshed(shapes::flat({"#.", "##"}, 5));
  expect_sound(result);
  EXPECT_EQ(result.mesh.faces.size(), 4u);
  EXPECT_EQ(result.report.output.area, 3);
}

TEST(remesh_surface, coplanar_faces_that_touch_at_a_vertex_are_two_patches) {
  const Result result = remeshed(shapes::two_squares_touching_at_a_vertex(3));
  expect_sound(result);
  EXPECT_EQ(result.report.patches.size(), 2u);
  EXPECT_EQ(result.mesh.positions.size(), 7u);
  EXPECT_EQ(result.report.output.area, 2);
}

TEST(remesh_surface, a_slot_in_a_straight_edge_is_not_bridged) {
  const Result result = remeshed(shapes::slotted_plate(2));
  expect_sound(result);
  EXPECT_EQ(result.report.patches.size(), 1u);
  EXPECT_EQ(result.mesh.positions.size(), 8u);
  EXPECT_EQ(result.report.output.area, 13);
}

TEST(remesh_surface, a_third_faces_corner_on_a_straight_border_stays) {
  // A sheet whose upper border has, on a part of it, a wall standing up; the wall's corners are on the border.
  const PolygonMesh mesh = shapes::from_lists(
      {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, 1}, {1, 1, 1}, {1, 0, 0}, {2, 0, 0}},
      {{0, 8, 4, 5}, {8, 9, 3, 4}, {9, 1, 2, 3}, {4, 3, 6, 7}});
  const Result result = remeshed(mesh);
  expect_sound(result);
  EXPECT_EQ(result.report.patches.size(), 2u);
  EXPECT_TRUE(has_vertex(result, {1, 1, 0}));
  EXPECT_TRUE(has_vertex(result, {2, 1, 0}));
  EXPECT_FALSE(has_vertex(result, {1, 0, 0}));
}

TEST(remesh_surface, a_double_sheet_stays_two) {
  // Both sheets are over the same four vertices. They are two squares, or they are cut along one diagonal above and
  // along the other one below.
  const std::vector<Vec3> corners = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  for (const auto& mesh : {shapes::from_lists(corners, {{0, 1, 2, 3}, {3, 2, 1, 0}}),
                           shapes::from_lists(corners, {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}})}) {
    const Result result = remeshed(mesh);
    expect_sound(result);
    EXPECT_EQ(result.report.patches.size(), 2u);
    EXPECT_TRUE(result.report.output.closed);
    EXPECT_EQ(result.report.output.area, 2);
    EXPECT_EQ(result.mesh.positions.size(), 4u);
    EXPECT_EQ(result.mesh.faces.size(), 4u);
  }
}

TEST(remesh_surface, both_sides_of_a_sheet_are_patches_that_share_no_inner_edge) {
  // Each inner edge of the input has four faces, two of each side.
  const Result result = remeshed(shapes::double_sheet(3));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.mesh.faces.size(), 4u);
  EXPECT_EQ(result.report.output.non_manifold_edges, 0u);
  EXPECT_NEAR(result.report.output.area, result.report.input.area, 1e-12);
}

TEST(remesh_surface, parallel_sheets_stay_two_however_close) {
  const PolygonMesh sheet = shapes::sheet(1, 1, 4, 4);
  for (const double gap : {0.1, 1e-6, 1e-12}) {
    const Result result = remeshed(shapes::joined(sheet, shapes::moved(sheet, {0, 0, gap})));
    expect_sound(result);
    EXPECT_EQ(result.report.patches.size(), 2u) << gap;
    EXPECT_EQ(result.mesh.positions.size(), 8u) << gap;
    EXPECT_EQ(result.report.output.area, 2) << gap;
  }
}

TEST(remesh_surface, a_tube_with_no_corner_on_its_rims_stays_round) {
  PolygonMesh tube = shapes::cylinder(48, 1, 2);
  // Without its caps: the first two faces.
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::size_t f = 2; f < tube.face_count(); ++f) {
    faces.emplace_back();
    for (const VertexId v : tube.face(FaceId(f))) faces.back().push_back(v.value);
  }
  const Result result = remeshed(shapes::from_lists(tube.positions.items(), faces));
  expect_sound(result);
  // Each of the 48 quads is two triangles.
  EXPECT_EQ(result.mesh.faces.size(), 2u * 48);
}

TEST(remesh_surface, vertices_keep_their_coordinates_bit_for_bit) {
  const PolygonMesh mesh = shapes::rotated(shapes::box({1, 2, 3}, 4), {1, 2, 3}, 33);
  const Result result = remeshed(mesh);
  expect_sound(result);
  const std::set<Vec3> input(mesh.positions.begin(), mesh.positions.end());
  for (const Vec3& p : result.mesh.positions) EXPECT_TRUE(input.count(p));
}

TEST(remesh_surface, concave_and_bridged_polygons_are_patches_like_others) {
  const Result bridge =
      remeshed(shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}}));
  expect_sound(bridge);
  EXPECT_EQ(bridge.report.patches[0].loops, 2u);
  EXPECT_EQ(bridge.mesh.faces.size(), 8u);
  EXPECT_EQ(bridge.report.output.area, 48);
  const Result prism = remeshed(shapes::prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, 2));
  expect_sound(prism);
  EXPECT_EQ(prism.report.patches.size(), 8u);
  EXPECT_DOUBLE_EQ(*prism.report.output.volume, 10);
}

TEST(remesh_surface, a_closed_box_of_any_cut_is_twelve_triangles) {
  for (const int cuts : {1, 3, 10}) {
    const Result result = remeshed(shapes::box({1, 2, 3}, cuts));
    expect_sound(result);
    EXPECT_EQ(result.mesh.faces.size(), 12u);
    EXPECT_EQ(*result.report.output.volume, 6);
    EXPECT_EQ(result.report.output.area, 22);
  }
}

TEST(remesh_surface, cubes_that_touch_along_an_edge_keep_its_four_faces) {
  const Result result = remeshed(shapes::blocks({"#.", ".#"}, 2));
  expect_sound(result);
  EXPECT_EQ(result.report.output.non_manifold_edges, 1u);
  EXPECT_EQ(result.mesh.faces.size(), 2u * 12);
}

std::vector<PolygonMesh> several_meshes() {
  return {shapes::ring(4), bracket(), shapes::sphere(3), shapes::two_squares_touching_at_a_vertex(2),
          shapes::rounded(shapes::rotated(bracket(), {1, 2, 3}, 40), 1e-6)};
}

STAGE(remesh_surface, test::kScale, test::kNumbering, test::kStop) {
  for (const PolygonMesh& mesh : several_meshes()) {
    const Result result = remesh_surface(trial.of(mesh), unrefined(), {trial.workers, true}, trial.control);
    trial.mesh(result.mesh);
    trial.same(result.report.patches.size());
    trial.in_order(result.face_patch, trial.length(result.report.plane_tolerance),
                   trial.length(trial.length(result.report.output.area)));
  }
}

STAGE(all_of_a_result, test::kWorkers) {
  std::vector<PolygonMesh> meshes = several_meshes();
  meshes.push_back(shapes::rotated(shapes::cylinder(64, 1, 2), {1, 2, 3}, 20));
  meshes.push_back(shapes::sphere(6));
  meshes.push_back(shapes::rounded(shapes::rotated(shapes::box({1, 2, 3}, 60), {1, 2, 3}, 40), 1e-6));
  for (const PolygonMesh& mesh : meshes) trial.in_order(all_bytes(remeshed(mesh, unrefined(), {trial.workers, true})));
}

TEST(remesh_surface, boxes_and_brackets_turned_and_printed_with_six_decimals_merge_into_their_planes) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed) {
    Random random(seed);
    const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const double angle = random.uniform(0, 360);
    const auto printed = [&](const PolygonMesh& mesh) {
      return shapes::rounded(shapes::rotated(mesh, axis, angle), 1e-6);
    };
    const Result box = remeshed(printed(shapes::box({1, 2, 3}, 8)));
    expect_sound(box);
    EXPECT_EQ(box.report.patches.size(), 6u) << seed;
    EXPECT_EQ(box.mesh.faces.size(), 12u) << seed;
    const Result part = remeshed(printed(bracket())), exact = remeshed(bracket());
    expect_sound(part);
    EXPECT_EQ(part.report.patches.size(), exact.report.patches.size()) << seed;
    EXPECT_EQ(part.mesh.faces.size(), exact.mesh.faces.size()) << seed;
  }
}

TEST(remesh_surface, full_doubles_turned_anyhow_merge_into_their_planes) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Random random(seed);
    const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    const double scale = std::pow(10, random.uniform(-6, 6));
    const PolygonMesh mesh =
        shapes::moved(shapes::scaled(shapes::rotated(shapes::box({1, 2, 3}, 6), axis, random.uniform(0, 360)), scale),
                      {10 * scale, -20 * scale, 30 * scale});
    const Result result = remeshed(mesh);
    expect_sound(result);
    EXPECT_EQ(result.mesh.faces.size(), 12u) << seed;
  }
}

TEST(remesh_surface, where_a_thin_plate_is_a_single_patch_no_corner_of_it_is_lost) {
  // A plate thinner than the tolerance, its caps fans. At the tip of a cap a triangle as narrow as two tolerances
  // joined the other cap by way of the rim, and went with its vertex, which was farther from all that was left.
  const std::vector<Vec2> outline{{10.4, -3.6}, {11.8, 3.6}, {7.2, 9.6},   {0.2, 12.1}, {-6.3, 9},
                                  {-11.4, 3.9}, {-9.7, -3},  {-6.1, -8.1}, {-0.2, -10}, {5.2, -7.4}};
  const auto n = static_cast<std::uint32_t>(outline.size());
  PolygonMesh mesh;
  for (const double z : {0.0, 0.05})
    for (const Vec2& p : outline) mesh.positions.push_back({p.x, p.y, z});
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    for (const std::uint32_t v : {a, b, c}) mesh.corners.emplace_back(v);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    add(i, j, n + j);
    add(i, n + j, n + i);
    if (i == 0 || j == 0) continue;
    add(n, n + i, n + j);
    add(0, j, i);
  }
  for (const double tolerance : {0.25, 0.3, 0.35}) {
    Options options;
    options.plane_tolerance = tolerance;
    options.max_edge_length = 0.25;
    const Result result = remeshed(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true());
    for (const Vec3& p : mesh.positions) {
      double nearest = HUGE_VAL;
      for (const Vec3& q : result.mesh.positions) nearest = std::min(nearest, norm(q - p));
      // No place of the output is farther from its vertices than that.
      EXPECT_LE(nearest, tolerance + 0.25 / std::sqrt(3));
    }
  }
}

TEST(remesh_surface, boundary_vertices_stay_where_asked) {
  Options options = unrefined();
  options.keep_boundary_vertices = true;
  const Result result = remeshed(shapes::sheet(2, 1, 4, 2), options);
  expect_sound(result);
  // The rim has 2 (4 + 2) vertices, and a polygon of n corners is n - 2 triangles.
  EXPECT_EQ(result.mesh.positions.size(), 12u);
  EXPECT_EQ(result.mesh.faces.size(), 10u);
  const Result box = remeshed(shapes::box({1, 1, 1}, 2), options);
  expect_sound(box);
  EXPECT_EQ(box.mesh.positions.size(), 8u + 12) << "its corners and the middles of its edges";
}

TEST(remesh_surface, the_reference_axis_changes_ties_at_most) {
  for (const Vec3& direction : {Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 0, 1}, Vec3{-3, 2, 7}}) {
    Options options = unrefined();
    options.reference_axis = ReferenceAxis::kGiven;
    options.reference_direction = direction;
    const Result result = remeshed(bracket(), options);
    expect_sound(result);
    EXPECT_EQ(result.mesh.faces.size(), remeshed(bracket()).mesh.faces.size());
  }
  Options options = unrefined();
  options.reference_axis = ReferenceAxis::kX;
  expect_sound(remeshed(shapes::box({1, 2, 3}, 2), options));
}

TEST(remesh_surface, groups_bound_patches_and_come_back) {
  const PolygonMesh mesh = with_groups(shapes::sheet(2, 1, 4, 2), {0, 0, 0, 0, 1, 1, 1, 1, 0, 0, 0, 0, 1, 1, 1, 1});
  const Result result = remeshed(mesh);
  expect_sound(result);
  EXPECT_EQ(result.report.patches.size(), 2u);
  EXPECT_EQ(result.mesh.faces.size(), 4u);
  ASSERT_EQ(result.mesh.labels.group.of_face.size(), 4u);
  for (std::uint32_t f = 0; f < 4; ++f) {
    const Triangle& t = result.mesh.faces[FaceId(f)];
    const double x = result.mesh.positions[t[0]].x + result.mesh.positions[t[1]].x + result.mesh.positions[t[2]].x;
    EXPECT_EQ(result.mesh.labels.group.of_face[FaceId(f)], x / 3 < 1 ? 0u : 1u);
  }

  Options none = unrefined();
  none.barriers = {false, false, false};
  const Result merged = remeshed(mesh, none);
  EXPECT_EQ(merged.report.patches.size(), 1u);
  EXPECT_EQ(merged.mesh.faces.size(), 2u);
  EXPECT_EQ(merged.mesh.labels.group.of_face.size(), 2u) << "each face is labelled by what lies under its centroid";
}

TEST(remesh_surface, the_source_of_each_face_lies_under_its_centroid) {
  const Result result = remeshed(shapes::sheet(4, 1, 4, 1), unrefined(), {1, true});
  ASSERT_EQ(result.face_source.size(), 2u);
  for (std::uint32_t f = 0; f < 2; ++f) {
    const Triangle& t = result.mesh.faces[FaceId(f)];
    const double x =
        (result.mesh.positions[t[0]].x + result.mesh.positions[t[1]].x + result.mesh.positions[t[2]].x) / 3;
    EXPECT_EQ(result.face_source[FaceId(f)].value / 2, static_cast<std::uint32_t>(x));
  }
  EXPECT_TRUE(remeshed(shapes::sheet(4, 1, 4, 1)).face_source.empty());
}

TEST(remesh_surface, each_input_face_has_its_patch_unless_it_was_dropped) {
  PolygonMesh cube = shapes::box({1, 1, 1});
  const std::size_t count = cube.face_count();
  // Its first face once more.
  for (std::uint32_t c = cube.face_begin[0]; c < cube.face_begin[1]; ++c) cube.corners.push_back(cube.corners[c]);
  cube.face_begin.push_back(static_cast<std::uint32_t>(cube.corners.size()));
  const Result result = remeshed(cube, unrefined(), {1, true});
  ASSERT_EQ(result.input_face_patch.size(), count + 1);
  EXPECT_FALSE(result.input_face_patch[FaceId(count)].is_valid());
  for (std::size_t f = 0; f < result.face_source.size(); ++f)
    EXPECT_EQ(result.input_face_patch[result.face_source[FaceId(f)]], result.face_patch[FaceId(f)]);
  EXPECT_TRUE(remeshed(cube, unrefined()).input_face_patch.empty());
}

/// n x n quads of which none is planar.
PolygonMesh wavy_quads(int n) {
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  const auto vertex = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) positions.push_back({1.0 * i, 1.0 * j, 0.1 * i * j});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      faces.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
  return shapes::from_lists(positions, faces);
}

const Diagnostic* find(const std::vector<Diagnostic>& diagnostics, DiagnosticCode code) {
  const auto found =
      std::find_if(diagnostics.begin(), diagnostics.end(), [&](const Diagnostic& d) { return d.code == code; });
  return found == diagnostics.end() ? nullptr : &*found;
}

TEST(remesh_surface, a_polygon_that_was_split_counts_as_the_one_face_that_it_is_in_the_input) {
  const Result bridge =
      remeshed(shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}}));
  ASSERT_EQ(bridge.report.patches.size(), 1u);
  EXPECT_EQ(bridge.report.patches[0].input_faces, 1u);

  constexpr int kSide = 8;
  PolygonMesh quads = wavy_quads(kSide);
  constexpr std::uint32_t kTurned = 11;
  std::reverse(quads.corners.begin() + 4 * kTurned, quads.corners.begin() + 4 * kTurned + 4);
  Options options;
  options.min_angle_deg = 0;
  const Report report = remeshed(quads, options).report;
  const Diagnostic* const turned = find(report.diagnostics, DiagnosticCode::kInconsistentWinding);
  ASSERT_NE(turned, nullptr);
  EXPECT_EQ(turned->count, 1u);
  EXPECT_EQ(turned->elements, std::vector<std::uint64_t>{kTurned});
  const Diagnostic* const curved = find(report.diagnostics, DiagnosticCode::kCurvedSurface);
  ASSERT_NE(curved, nullptr);
  EXPECT_EQ(curved->count, std::uint64_t{kSide * kSide});
  EXPECT_EQ(std::set(curved->elements.begin(), curved->elements.end()).size(), curved->elements.size());
}

TEST(remesh_surface, a_curved_surface_is_warned_of_where_it_is_to_be_refined_and_beforehand) {
  const PolygonMesh sphere = shapes::sphere(2);
  RunControl control;
  for (const Options& options : {Options(), unrefined()}) {
    const Report analysed = analyze_surface(sphere, options, {}, control);
    const Result result = remeshed(sphere, options);
    for (const Report& report : {analysed, result.report}) {
      const Diagnostic* const curved = find(report.diagnostics, DiagnosticCode::kCurvedSurface);
      ASSERT_EQ(curved != nullptr, options.refine);
      if (options.refine) {
        EXPECT_EQ(curved->count, sphere.face_count());
      }
    }
  }
}

TEST(remesh_surface, a_curved_surface_is_told_of_where_its_facets_are_pairs_of_triangles) {
  constexpr int kSides = 24;
  const PolygonMesh rod = shapes::fan_triangulated(shapes::cylinder(kSides, 1, 3));
  RunControl control;
  Options each_facet_is_a_surface;
  each_facet_is_a_surface.feature_angle_deg = 0;
  for (const Options& options : {Options(), each_facet_is_a_surface}) {
    const Report analysed = analyze_surface(rod, options, {}, control);
    const Result result = remeshed(rod, options);
    for (const Report& report : {analysed, result.report}) {
      const Diagnostic* const curved = find(report.diagnostics, DiagnosticCode::kCurvedSurface);
      ASSERT_EQ(curved != nullptr, options.feature_angle_deg > 0);
      if (curved == nullptr) continue;
      EXPECT_EQ(curved->count, std::uint64_t{2 * kSides});
      EXPECT_NE(curved->message.find("1 cylinder, made of 24 facets;"), std::string::npos) << curved->message;
    }
  }
  EXPECT_EQ(find(remeshed(shapes::box({1, 1, 1}), {}).report.diagnostics, DiagnosticCode::kCurvedSurface), nullptr);
}

TEST(remesh_surface, diagnostics_of_the_reader_are_passed_on) {
  RunControl control;
  const Result result = remesh_surface(shapes::sheet(1, 1, 1, 1), unrefined(), {}, control,
                                       {{DiagnosticCode::kAttributeDropped, 3, {}, "texture coordinates"}});
  ASSERT_FALSE(result.report.diagnostics.empty());
  EXPECT_EQ(result.report.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
}

TEST(remesh_surface, a_strip_that_runs_over_itself_goes_down_the_ladder_and_is_verified) {
  const Result result = remeshed(shapes::strip_over_itself());
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(std::any_of(result.report.patches.begin(), result.report.patches.end(), [](const PatchSummary& p) {
    return p.status == PatchStatus::kReduced && p.reason == PatchReason::kSelfIntersectingLoop;
  }));
}

TEST(remesh_surface, a_closed_surface_with_zero_area_faces_stays_closed) {
  const PolygonMesh mesh = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 0, 0}},
                                              {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 4}});
  const Result result = remeshed(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_EQ(result.mesh.faces.size(), 4u);
}

/// Returns why a mesh does not come back verified, or an empty text if it does.
std::string failure_of(const PolygonMesh& mesh) {
  try {
    const Result result = remeshed(mesh);
    return result.report.verified.all_true() ? "" : "not verified";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(remesh_surface, faces_thinner_than_any_grid_come_back_or_are_named) {
  for (const double t : {1e-20, 1e-29, 1e-50, 1e-100, 1e-170, 1e-300}) {
    const std::vector<Vec3> corners{{0, 0, 0}, {t, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (const std::vector<std::vector<std::uint32_t>>& faces :
         {std::vector<std::vector<std::uint32_t>>{{0, 1, 2}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}) {
      std::vector<Vec3> used = corners;
      if (faces.size() == 1) used.pop_back();
      // A lone face of less than 2^-100 of its length is a line to every computation.
      if (t < 0x1p-100 && faces.size() == 1) {
        const auto error = error_of([&] { remeshed(shapes::from_lists(used, faces), unrefined()); });
        EXPECT_EQ(error.code, Code::kCoordinateRange) << t;
        EXPECT_TRUE(error.element.has_value()) << t;
        continue;
      }
      const Result result = remeshed(shapes::from_lists(used, faces), unrefined());
      EXPECT_TRUE(result.report.verified.all_true()) << t;
      EXPECT_EQ(result.mesh.faces.size(), faces.size()) << t;
    }
  }
}

TEST(remesh_surface, a_polygon_that_runs_back_along_its_own_side_is_verified) {
  // A corner lies on another side, in frames in which rounding hides it and in such as show it.
  EXPECT_EQ(failure_of(shapes::polygon({{1, 0}, {0, 1}, {0, 0}, {0, 2}})), "");
  EXPECT_EQ(failure_of(shapes::polygon({{2, 1}, {2, 0}, {2, 2}, {0, 1}})), "");
}

TEST(remesh_surface, a_polygon_that_touches_itself_in_a_corner_is_verified) {
  EXPECT_EQ(failure_of(shapes::polygon({{0, 0}, {2, 0}, {2, 1}, {0, 0}, {1, 2}, {0, 2}})), "");
}

TEST(remesh_surface, a_polygon_with_a_spike_through_its_corner_is_verified) {
  EXPECT_EQ(failure_of(shapes::from_lists({{0, 0, 1}, {0, 0, 2}, {1, 1, 2}, {0, 0, 0}}, {{0, 1, 2, 0, 3}})), "");
}

TEST(remesh_surface, a_vertex_handed_over_by_a_zero_area_face_may_make_the_edge_of_another_face) {
  // The face 1 0 2 gets the vertex 3 of the zero-area face on its side 0-2; its one diagonal is then an edge of 0 3 1.
  EXPECT_EQ(
      failure_of(shapes::from_lists({{2, 2, 0}, {0, 1, 0}, {0, 2, 0}, {1, 2, 0}}, {{1, 0, 2}, {0, 3, 2}, {0, 3, 1}})),
      "");
}

TEST(remesh_surface, meshes_without_a_face_or_an_area_are_empty) {
  EXPECT_EQ(error_of([] { remeshed(shapes::from_lists({{0, 0, 0}}, {})); }).code, Code::kEmptyMesh);
  EXPECT_EQ(error_of([] { remeshed({}); }).code, Code::kEmptyMesh);
  EXPECT_EQ(error_of([] {
              remeshed(shapes::from_lists({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}}));
            }).code,
            Code::kEmptyMesh);
  EXPECT_EQ(error_of([] {
              remeshed(shapes::from_lists({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}));
            }).code,
            Code::kEmptyMesh);
}

TEST(remesh_surface, a_result_larger_than_allowed_is_refused) {
  Options options = unrefined();
  options.max_output_faces = 11;
  const Error error = error_of([&] { remeshed(shapes::box({1, 1, 1}, 3), options); });
  EXPECT_EQ(error.code, Code::kOutputTooLarge);
  EXPECT_EQ(error.limit, 11u);
  EXPECT_EQ(error.option, "max_output_faces");
  options.max_output_faces = 12;
  EXPECT_EQ(remeshed(shapes::box({1, 1, 1}, 3), options).mesh.faces.size(), 12u);
}

TEST(remesh_surface, a_stop_is_obeyed_soon_at_any_time) {
  const PolygonMesh mesh = shapes::box({1, 1, 1}, 290);  // a million faces
  for (const int wait_ms : {30, 300, 900}) {
    const auto took = test::time_to_stop(std::chrono::milliseconds(wait_ms), [&](RunControl& control) {
      remesh_surface(mesh, unrefined(), {2, false}, control);
    });
    // The promise is 100 ms, which are 200 ms of two threads.
    if (took) test::expect_within(test::Seconds(1), *took, "asked after " + std::to_string(wait_ms) + " ms");
  }
}

TEST(analyze_surface, it_tells_of_the_input_and_has_no_result) {
  RunControl control;
  const Report report = analyze_surface(bracket(), unrefined(), {}, control);
  const Result result = remeshed(bracket());
  EXPECT_EQ(report.patches.size(), result.report.patches.size());
  EXPECT_EQ(report.predicted_faces, result.mesh.faces.size());
  EXPECT_EQ(report.input.area, result.report.input.area);
  EXPECT_EQ(report.output.faces, 0u);
  EXPECT_FALSE(report.verified.surface);
}

}  // namespace
}  // namespace remesh
