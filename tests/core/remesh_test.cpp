#include "core/remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <thread>

#include "core/io/obj.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/unrefined_options.h"

namespace remesh {
namespace {

Result remeshed(const PolygonMesh& mesh, const Options& options = unrefined(), const RunSettings& settings = {}) {
  RunControl control;
  return remesh_surface(mesh, options, settings, control);
}

/// Everything that a caller sees and that must not depend on workers or luck, as text.
std::string bytes(const Result& result) {
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
      << result.report.predicted_faces << ' ' << result.report.verified.deviation;
  for (const PatchSummary& p : result.report.patches)
    out << '\n'
        << p.normal.x << ' ' << p.normal.y << ' ' << p.normal.z << ' ' << p.offset << ' ' << p.area << ' '
        << p.input_faces << ' ' << p.output_faces << ' ' << p.loops << ' ' << p.essential_vertices << ' '
        << status_name(p.status) << reason_name(p.reason) << ' ' << p.deviation;
  for (const Diagnostic& d : result.report.diagnostics) {
    out << '\n' << diagnostic_name(d.code) << ' ' << d.count << ' ' << d.message;
    for (const std::uint64_t e : d.elements) out << ' ' << e;
  }
  return out.str();
}

/// The output's triangles by position, for comparison across numberings.
std::multiset<std::vector<Vec3>> triangle_set(const Result& result) {
  std::multiset<std::vector<Vec3>> set;
  for (const Triangle& t : result.mesh.faces) {
    std::vector<Vec3> corners{result.mesh.positions[t[0]], result.mesh.positions[t[1]], result.mesh.positions[t[2]]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    set.insert(corners);
  }
  return set;
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
  EXPECT_EQ(result.mesh.faces.size(), result.report.predicted_faces);
  ASSERT_EQ(result.face_patch.size(), result.mesh.faces.size());
  std::vector<std::uint64_t> faces(result.report.patches.size());
  for (const PatchId p : result.face_patch) ++faces[p.value];
  for (std::size_t p = 0; p < faces.size(); ++p) EXPECT_EQ(faces[p], result.report.patches[p].output_faces);
}

Error error_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(Code::kInternal, Stage::kQueued, "");
}

/// A part with several kinds of patches: a plate with a hole on legs.
PolygonMesh bracket() { return shapes::blocks({"####", "#..#", "####", "#..#"}, 3); }

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
  // Over the same four vertices: as two squares, and cut along one diagonal above and along the other one below.
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

TEST(remesh_surface, sheets_whose_inner_edges_are_shared_keep_every_face) {
  // Each inner edge has four faces: nothing says which two belong together.
  const Result result = remeshed(shapes::double_sheet(3));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.mesh.faces.size(), 36u);
  EXPECT_EQ(result.report.output.non_manifold_edges, result.report.input.non_manifold_edges);
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
  EXPECT_EQ(result.mesh.faces.size(), 96u);
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
  EXPECT_EQ(result.mesh.faces.size(), 24u);
}

TEST(remesh_surface, bytes_are_the_same_for_any_number_of_workers_and_on_every_run) {
  for (const PolygonMesh& mesh :
       {shapes::ring(8), bracket(), shapes::sphere(4), shapes::rotated(shapes::cylinder(64, 1, 2), {1, 2, 3}, 20),
        shapes::rounded(shapes::rotated(shapes::box({1, 2, 3}, 12), {1, 2, 3}, 40), 1e-6)}) {
    const std::string expected = bytes(remeshed(mesh, unrefined(), {1, true}));
    for (const int workers : {1, 2, 8, 2})
      EXPECT_EQ(bytes(remeshed(mesh, unrefined(), {workers, true})), expected) << workers;
  }
}

TEST(remesh_surface, scaling_by_powers_of_two_gives_the_same_faces) {
  for (const PolygonMesh& mesh : {shapes::ring(4), bracket(), shapes::sphere(3),
                                  shapes::rounded(shapes::rotated(shapes::box({1, 2, 3}, 5), {1, 2, 3}, 40), 1e-6)}) {
    const Result expected = remeshed(mesh);
    for (const int k : {-40, -17, -3, -1, 1, 5, 20, 40}) {
      const double scale = std::ldexp(1.0, k);
      const Result result = remeshed(shapes::scaled(mesh, scale));
      EXPECT_EQ(result.mesh.faces.items(), expected.mesh.faces.items()) << k;
      EXPECT_EQ(result.face_patch.items(), expected.face_patch.items()) << k;
      EXPECT_EQ(result.report.plane_tolerance, scale * expected.report.plane_tolerance) << k;
      EXPECT_EQ(result.report.output.area, scale * scale * expected.report.output.area) << k;
    }
  }
}

TEST(remesh_surface, renumbering_changes_no_triangle) {
  for (const PolygonMesh& mesh :
       {shapes::ring(4), bracket(), shapes::sphere(3), shapes::two_squares_touching_at_a_vertex(2),
        shapes::rounded(shapes::rotated(bracket(), {1, 2, 3}, 40), 1e-6)}) {
    const Result expected = remeshed(mesh);
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const Result result = remeshed(shapes::renumbered(mesh, seed));
      EXPECT_EQ(result.report.patches.size(), expected.report.patches.size());
      EXPECT_EQ(triangle_set(result), triangle_set(expected)) << seed;
    }
  }
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

TEST(remesh_surface, noise_within_a_given_tolerance_merges_and_beyond_it_does_not) {
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
  expect_sound(kept);
}

TEST(remesh_surface, boundary_vertices_stay_where_asked) {
  Options options = unrefined();
  options.keep_boundary_vertices = true;
  const Result result = remeshed(shapes::sheet(2, 1, 4, 2), options);
  expect_sound(result);
  EXPECT_EQ(result.mesh.positions.size(), 12u);
  EXPECT_EQ(result.mesh.faces.size(), 10u);
  const Result box = remeshed(shapes::box({1, 1, 1}, 2), options);
  expect_sound(box);
  EXPECT_EQ(box.mesh.positions.size(), 20u);
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

TEST(remesh_surface, diagnostics_of_the_reader_are_passed_on) {
  RunControl control;
  const Result result = remesh_surface(shapes::sheet(1, 1, 1, 1), unrefined(), {}, control,
                                       {{DiagnosticCode::kAttributeDropped, 3, {}, "texture coordinates"}});
  ASSERT_FALSE(result.report.diagnostics.empty());
  EXPECT_EQ(result.report.diagnostics[0].code, DiagnosticCode::kAttributeDropped);
}

TEST(remesh_surface, a_strip_that_runs_over_itself_goes_down_the_ladder_and_is_verified) {
  // Coplanar, 450 degrees round: the loop of the one plane crosses itself.
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i <= 40; ++i) {
    const double angle = 450.0 / 40 * i * 3.14159265358979 / 180;
    for (const double radius : {1.0, 2.0 + 0.001 * i})
      positions.push_back({radius * std::cos(angle) + 0.0005 * i, radius * std::sin(angle), 0});
    const auto k = static_cast<std::uint32_t>(2 * i);
    if (i < 40) faces.push_back({k, k + 1, k + 3, k + 2});
  }
  const Result result = remeshed(shapes::from_lists(positions, faces));
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

/// Why a mesh does not come back verified; empty if it does.
std::string failure_of(const PolygonMesh& mesh) {
  try {
    const Result result = remeshed(mesh);
    return result.report.verified.all_true() ? "" : "not verified";
  } catch (const Error& error) {
    return error.what();
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

TEST(remesh_surface, a_run_that_was_stopped_before_it_began_does_nothing) {
  RunControl control;
  control.cancel();
  EXPECT_EQ(error_of([&] { remesh_surface(shapes::box({1, 1, 1}), {}, {}, control); }).code, Code::kCancelled);
}

TEST(remesh_surface, a_stop_is_obeyed_soon_at_any_time) {
  using Clock = std::chrono::steady_clock;
  const PolygonMesh mesh = shapes::box({1, 1, 1}, 290);  // a million faces
  for (const int wait_ms : {30, 300, 900}) {
    RunControl control;
    Clock::time_point asked;
    std::thread watcher([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
      asked = Clock::now();
      control.cancel();
    });
    bool is_stopped = false;
    try {
      remesh_surface(mesh, unrefined(), {2, false}, control);
    } catch (const Error& error) {
      is_stopped = error.code == Code::kCancelled;
    }
    const Clock::time_point ended = Clock::now();
    watcher.join();
    if (!is_stopped) continue;  // a machine so fast that it was done before
    // The promise is 100 ms; the margin is for slow builds and busy machines.
    EXPECT_LT(std::chrono::duration<double>(ended - asked).count(), 1.0) << "asked after " << wait_ms << " ms";
  }
}

// What is mended, and what is told of it.

const Diagnostic* find(const Report& report, DiagnosticCode code) {
  const auto found = std::find_if(report.diagnostics.begin(), report.diagnostics.end(),
                                  [&](const Diagnostic& d) { return d.code == code; });
  return found == report.diagnostics.end() ? nullptr : &*found;
}
std::uint64_t count_of(const Report& report, DiagnosticCode code) {
  std::uint64_t count = 0;
  for (const Diagnostic& d : report.diagnostics)
    if (d.code == code) count += d.count;
  return count;
}
const VolumeObstacle* obstacle(const Report& report, DiagnosticCode code) {
  const auto found = std::find_if(report.volume_obstacles.begin(), report.volume_obstacles.end(),
                                  [&](const VolumeObstacle& o) { return o.code == code; });
  return found == report.volume_obstacles.end() ? nullptr : &*found;
}

Options without_repair() {
  Options options = unrefined();
  options.repair = {false, false, false, false, false};
  return options;
}

/// A unit cube of quads, the upper one in two halves: their ends in the middle are on edges of the sides.
PolygonMesh cube_with_t_junctions() {
  return shapes::from_lists(
      {{0, 0, 0},
       {1, 0, 0},
       {1, 1, 0},
       {0, 1, 0},
       {0, 0, 1},
       {1, 0, 1},
       {1, 1, 1},
       {0, 1, 1},
       {0.5, 0, 1},
       {0.5, 1, 1}},
      {{3, 2, 1, 0}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}, {4, 8, 9, 7}, {8, 5, 6, 9}});
}

TEST(remesh_surface, t_junctions_are_closed_by_splitting) {
  const Result mended = remeshed(cube_with_t_junctions());
  EXPECT_TRUE(mended.report.verified.all_true());
  EXPECT_TRUE(mended.report.output.closed);
  EXPECT_EQ(mended.mesh.faces.size(), 12u);
  EXPECT_TRUE(mended.report.volume_obstacles.empty());
  ASSERT_NE(find(mended.report, DiagnosticCode::kTJunction), nullptr);
  EXPECT_EQ(find(mended.report, DiagnosticCode::kTJunction)->elements, (std::vector<std::uint64_t>{8, 9}));

  const Result left = remeshed(cube_with_t_junctions(), without_repair());
  EXPECT_TRUE(left.report.verified.all_true());
  EXPECT_FALSE(left.report.output.closed);
  EXPECT_EQ(count_of(left.report, DiagnosticCode::kTJunction), 2u);
  ASSERT_NE(obstacle(left.report, DiagnosticCode::kOpenBoundary), nullptr);
}

TEST(remesh_surface, every_mending_together_gives_the_box_again) {
  // Repeated, turned over at random, with a zero-area face between two triangles.
  for (int seed = 0; seed < 10; ++seed) {
    Random random(seed);
    PolygonMesh mesh = shapes::box({1, 2, 3}, 4);
    const std::size_t faces = mesh.face_count();
    for (std::size_t f = 0; f < faces; ++f) {
      const bool is_turned = random.chance(0.2);
      if (is_turned)
        std::reverse(mesh.corners.begin() + mesh.face_begin[f], mesh.corners.begin() + mesh.face_begin[f + 1]);
      if (!random.chance(0.1)) continue;
      const std::vector<VertexId> loop(mesh.face(FaceId(f)).begin(), mesh.face(FaceId(f)).end());
      mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    const Result result = remeshed(mesh);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(result.mesh.faces.size(), 12u);
    EXPECT_DOUBLE_EQ(result.report.output.volume.value_or(0), 6);
    EXPECT_TRUE(result.report.volume_obstacles.empty());
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kDuplicateFace), mesh.face_count() - faces);
    EXPECT_GT(count_of(result.report, DiagnosticCode::kInconsistentWinding), 0u);
  }
}

TEST(remesh_surface, whatever_is_left_unmended_comes_back_verified) {
  for (int seed = 0; seed < 32; ++seed) {
    PolygonMesh mesh = shapes::joined(cube_with_t_junctions(),
                                      shapes::moved(shapes::turned_over(shapes::box({1, 1, 1}, 2)), {3, 0, 0}));
    std::reverse(mesh.corners.begin(), mesh.corners.begin() + 4);
    for (const std::uint32_t f : {10u, 11u}) {  // once more, and once from behind
      std::vector<VertexId> loop(mesh.face(FaceId(f)).begin(), mesh.face(FaceId(f)).end());
      if (f == 11) std::reverse(loop.begin(), loop.end());
      mesh.corners.insert(mesh.corners.end(), loop.begin(), loop.end());
      mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    }
    const auto first = mesh.face(FaceId(12));
    const VertexId middle = mesh.positions.push_back(0.5 * (mesh.positions[first[0]] + mesh.positions[first[1]]));
    for (const VertexId v : {first[0], middle, first[1]}) mesh.corners.push_back(v);
    mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
    Options options = unrefined();
    options.repair = {(seed & 1) != 0, (seed & 2) != 0, (seed & 4) != 0, (seed & 8) != 0, (seed & 16) != 0};
    const Result result = remeshed(mesh, options);
    EXPECT_TRUE(result.report.verified.all_true()) << seed;
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kTJunction) > 0, true) << seed;
    EXPECT_GE(count_of(result.report, DiagnosticCode::kDuplicateFace), 2u) << seed;
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kZeroAreaFace), 1u) << seed;
    EXPECT_GT(count_of(result.report, DiagnosticCode::kInconsistentWinding), 0u) << seed;
  }
}

TEST(remesh_surface, a_solid_inside_out_is_reported_and_turned_only_on_request) {
  const PolygonMesh mesh = shapes::turned_over(shapes::box({1, 2, 3}, 2));
  Options options = unrefined();
  const Result reported = remeshed(mesh, options);
  EXPECT_DOUBLE_EQ(*reported.report.output.volume, -6);
  EXPECT_EQ(count_of(reported.report, DiagnosticCode::kInsideOut), 1u);
  EXPECT_NE(obstacle(reported.report, DiagnosticCode::kInsideOut), nullptr);
  options.repair.inside_out = true;
  const Result turned = remeshed(mesh, options);
  EXPECT_DOUBLE_EQ(*turned.report.output.volume, 6);
  EXPECT_EQ(count_of(turned.report, DiagnosticCode::kInsideOut), 1u);
  EXPECT_TRUE(turned.report.volume_obstacles.empty());
}

TEST(remesh_surface, a_soup_whose_corners_nearly_meet_is_closed_by_its_weld_tolerance) {
  Random random(7);
  const PolygonMesh box = shapes::box({1, 1, 1}, 3);
  PolygonMesh soup;
  for (const VertexId v : box.corners) {
    Vec3 noise{random.unit(), random.unit(), random.unit()};
    soup.corners.push_back(soup.positions.push_back(box.positions[v] + 1e-6 * noise));
  }
  soup.face_begin = box.face_begin;
  Options options = unrefined();
  options.plane_tolerance = 1e-5;
  EXPECT_FALSE(remeshed(soup, options).report.output.closed);
  options.weld_tolerance = 4e-6;
  const Result result = remeshed(soup, options);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_EQ(result.mesh.faces.size(), 12u);
  EXPECT_EQ(count_of(result.report, DiagnosticCode::kDuplicateVertex), soup.vertex_count() - box.vertex_count());
}

TEST(remesh_surface, labels_and_sources_are_right_after_mending) {
  PolygonMesh mesh = cube_with_t_junctions();
  const std::vector<VertexId> repeat{VertexId(5), VertexId(6), VertexId(9), VertexId(8)};
  mesh.corners.insert(mesh.corners.end(), repeat.begin(), repeat.end());
  mesh.face_begin.push_back(static_cast<std::uint32_t>(mesh.corners.size()));
  std::reverse(mesh.corners.begin() + mesh.face_begin[2], mesh.corners.begin() + mesh.face_begin[3]);
  mesh = with_groups(mesh, {0, 1, 2, 3, 4, 5, 6, 7});
  RunSettings settings;
  settings.want_face_source = true;
  const Result result = remeshed(mesh, unrefined(), settings);
  EXPECT_TRUE(result.report.output.closed);
  EXPECT_EQ(result.report.patches.size(), 7u);
  EXPECT_DOUBLE_EQ(*result.report.output.volume, 1);
  std::set<std::uint32_t> groups;
  for (std::uint32_t i = 0; i < result.mesh.faces.size(); ++i) {
    const FaceId f(i), source = result.face_source[f];
    EXPECT_EQ(result.mesh.labels.group.of_face[f], mesh.labels.group.of_face[source]);
    groups.insert(result.mesh.labels.group.of_face[f]);
    const auto& [a, b, c] = result.mesh.faces[f];
    const Vec3 centroid = (1.0 / 3) * (result.mesh.positions[a] + result.mesh.positions[b] + result.mesh.positions[c]);
    Box3 box;
    for (const VertexId v : mesh.face(source)) box.add(mesh.positions[v]);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(centroid[axis], box.min[axis] - 1e-12);
      EXPECT_LE(centroid[axis], box.max[axis] + 1e-12);
    }
  }
  EXPECT_EQ(groups, (std::set<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}));
}

TEST(remesh_surface, faces_that_cross_are_found_and_located) {
  const PolygonMesh mesh =
      shapes::joined(shapes::box({4, 4, 4}, 9), shapes::moved(shapes::box({1, 1, 4}, 5), {1.1, 1.2, 2.03}));
  const Result result = remeshed(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  const Diagnostic* found = find(result.report, DiagnosticCode::kSelfIntersection);
  ASSERT_NE(found, nullptr);
  EXPECT_EQ(found->count, *result.report.input.intersecting_pairs);
  EXPECT_EQ(found->elements.size(), Diagnostic::kMaxElements);
  for (std::size_t i = 0; i < found->elements.size(); i += 2) {
    EXPECT_LT(found->elements[i], shapes::box({4, 4, 4}, 9).face_count());
    EXPECT_GE(found->elements[i + 1], shapes::box({4, 4, 4}, 9).face_count());
  }
  const VolumeObstacle* crossing = obstacle(result.report, DiagnosticCode::kSelfIntersection);
  ASSERT_NE(crossing, nullptr);
  EXPECT_EQ(crossing->count, *result.report.output.intersecting_pairs);
  for (const Vec3& p : crossing->places) EXPECT_DOUBLE_EQ(p.z, 4);
  for (const PatchSummary& p : result.report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed);
}

TEST(remesh_surface, a_face_that_hangs_on_a_polygons_diagonal_touches_it) {
  const PolygonMesh mesh =
      shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}, {0, 0, -1}}, {{0, 1, 2, 3}, {0, 2, 4}});
  const Result result = remeshed(mesh);
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_EQ(result.report.input.intersecting_pairs, 1u);
  for (const PatchSummary& p : result.report.patches) EXPECT_EQ(p.status, PatchStatus::kRemeshed);
}

TEST(remesh_surface, two_sheets_on_each_other_overlap) {
  const PolygonMesh flat = shapes::sheet(2, 2, 3, 3);
  const Result result = remeshed(shapes::joined(flat, shapes::moved(flat, {0.3, 0.2, 0})));
  EXPECT_TRUE(result.report.verified.all_true());
  EXPECT_GT(count_of(result.report, DiagnosticCode::kOverlappingFaces), 0u);
  EXPECT_NE(obstacle(result.report, DiagnosticCode::kOverlappingFaces), nullptr);
}

/// A sheet with a dip in its middle, and a triangle that stands in the dip without touching it.
PolygonMesh tip_in_a_dip() {
  PolygonMesh sheet = shapes::sheet(8, 8, 8, 8);
  for (Vec3& p : sheet.positions)
    if (p == Vec3{4, 4, 0}) p.z = -0.008;
  return shapes::joined(sheet, shapes::from_lists({{4, 4, -0.004}, {4.5, 4, 1}, {4, 4.5, 1}}, {{0, 1, 2}}));
}

TEST(remesh_surface, flattening_makes_no_faces_cross_that_did_not) {
  Options options = unrefined();
  options.plane_tolerance = 0.02;
  for (const bool refine : {false, true}) {
    options.refine = refine;
    const Result result = remeshed(tip_in_a_dip(), options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(*result.report.input.intersecting_pairs, 0u);
    EXPECT_EQ(*result.report.output.intersecting_pairs, 0u);
    EXPECT_TRUE(std::any_of(result.report.patches.begin(), result.report.patches.end(), [](const PatchSummary& p) {
      return p.status == PatchStatus::kReduced && p.reason == PatchReason::kVerificationFailed;
    }));
  }
  // Without the tip the sheet is one patch.
  PolygonMesh alone = tip_in_a_dip();
  alone.face_begin.pop_back();
  alone.corners.resize(alone.face_begin.back());
  EXPECT_EQ(remeshed(alone, options).report.patches.size(), 1u);
}

TEST(remesh_surface, two_nearly_coplanar_patches_over_one_bent_border_do_not_share_a_diagonal) {
  // Both sheets of a pillow: over the same four vertices, whose shorter diagonal both would take.
  for (int seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const double bend = 1e-4 * random.unit();
    const std::vector<Vec3> points{{-1, 0, 0},     {0, -1.3, bend}, {1, 0, 0},
                                   {0, 1.3, bend}, {0, 0, 0.002},   {0, 0, -0.002}};
    const PolygonMesh mesh = shapes::from_lists(
        points, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
    Options options = unrefined();
    options.plane_tolerance = 0.01;
    const Result result = remeshed(shapes::rotated(mesh, {1, 2, 3}, 17.0 * seed), options);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_FALSE(result.mesh.faces.empty());
    EXPECT_TRUE(result.report.output.closed);
    EXPECT_EQ(result.report.output.non_manifold_edges, 0u);
    EXPECT_EQ(count_of(result.report, DiagnosticCode::kNonManifoldEdge), 0u);
  }
}

TEST(remesh_surface, a_cylinder_of_a_thousand_facets_in_full_doubles_keeps_them_all) {
  const PolygonMesh cylinder = shapes::rotated(shapes::cylinder(1000, 1, 2), {1, 2, 3}, 40);
  for (const PolygonMesh& mesh : {cylinder, shapes::scaled(cylinder, 1e-3), shapes::moved(cylinder, {3, 4, 5})}) {
    const Result result = remeshed(mesh);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_EQ(result.report.patches.size(), 1002u);
    EXPECT_EQ(result.mesh.faces.size(), 2u * 998 + 2 * 1000);
  }
}

TEST(analyze_surface, it_tells_of_the_input_and_remeshes_nothing) {
  RunControl control;
  const Report report = analyze_surface(bracket(), unrefined(), {}, control);
  const Result result = remeshed(bracket());
  EXPECT_EQ(report.patches.size(), result.report.patches.size());
  EXPECT_EQ(report.predicted_faces, result.mesh.faces.size());
  EXPECT_EQ(report.input.area, result.report.input.area);
  EXPECT_EQ(report.output.faces, 0u);
  EXPECT_FALSE(report.verified.surface);
}

struct BadOption {
  const char* name;
  Code code;
  std::function<void(Options&)> set;
};

TEST(check_options, each_option_at_fault_is_named) {
  const std::vector<BadOption> bad = {
      {"min_angle_deg", Code::kInvalidOption, [](Options& o) { o.min_angle_deg = 33.5; }},
      {"min_angle_deg", Code::kInvalidOption, [](Options& o) { o.min_angle_deg = NAN; }},
      {"max_radius_edge_ratio", Code::kInvalidOption,
       [](Options& o) { o.min_angle_deg = o.max_radius_edge_ratio = 1; }},
      {"max_edge_length", Code::kInvalidOption, [](Options& o) { o.max_edge_length = 0; }},
      {"max_edge_fraction", Code::kInvalidOption, [](Options& o) { o.max_edge_length = o.max_edge_fraction = 1; }},
      {"max_area", Code::kInvalidOption, [](Options& o) { o.max_area = -1; }},
      {"min_edge_length", Code::kInvalidOption, [](Options& o) { o.min_edge_length = HUGE_VAL; }},
      {"min_edge_length", Code::kInvalidOption,
       [](Options& o) {
         o.min_edge_length = 2;
         o.max_edge_length = 1;
       }},
      {"proximity", Code::kInvalidOption, [](Options& o) { o.proximity = -1; }},
      {"gradation", Code::kInvalidOption, [](Options& o) { o.gradation = 1; }},
      {"weld_tolerance", Code::kInvalidOption, [](Options& o) { o.weld_tolerance = -1; }},
      {"plane_tolerance", Code::kInvalidOption, [](Options& o) { o.plane_tolerance = 0; }},
      {"plane_tolerance", Code::kInvalidOption, [](Options& o) { o.plane_tolerance = NAN; }},
      {"normal_tolerance", Code::kInvalidOption, [](Options& o) { o.normal_tolerance = -1; }},
      {"normal_tolerance", Code::kInvalidOption, [](Options& o) { o.normal_tolerance = 1; }},
      {"reference_axis", Code::kInvalidOption, [](Options& o) { o.reference_axis = ReferenceAxis::kGiven; }},
  };
  for (const BadOption& b : bad) {
    Options options;
    b.set(options);
    const Error error = error_of([&] { check_options(options); });
    EXPECT_EQ(code_name(error.code), code_name(b.code)) << b.name;
    EXPECT_EQ(error.option, b.name);
    EXPECT_EQ(error_of([&] { remeshed(shapes::box({1, 1, 1}), options); }).option, b.name);
  }
  EXPECT_NO_THROW(check_options(Options{}));
}

TEST(remesh_surface, a_bent_polygon_whose_every_cut_is_an_edge_already_is_answered) {
  // Three triangles of a tetrahedron, and a quad over all four of its corners: either diagonal has faces.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 2, 1}}, {{0, 1, 3}, {0, 1, 2, 3}, {1, 2, 3}, {2, 0, 3}});
  for (const bool refine : {false, true}) {
    Options options;
    options.refine = refine;
    RunControl control;
    const Result result = remesh_surface(mesh, options, {}, control);
    EXPECT_TRUE(result.report.verified.all_true());
    EXPECT_GE(result.mesh.faces.size(), 4u);
    EXPECT_EQ(result.report.output.non_manifold_edges, result.report.input.non_manifold_edges + 1);
  }
}

}  // namespace
}  // namespace remesh
