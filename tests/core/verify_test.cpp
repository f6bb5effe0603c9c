#include "core/verify.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "tests/core/verify/example.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

// The base cases, all correct.

Example cube() { return example(shapes::box({1, 1, 1}, 4), shapes::box({1, 1, 1}, 1)); }
Example ring() { return example(shapes::ring(4), shapes::ring(1)); }

/// The L without the vertices inside its long sides.
PolygonMesh minimal_l() {
  return shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}},
                            {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}});
}
Example flat_l() { return example(shapes::flat({"#.", "##"}, 3), minimal_l()); }

/// A plate with a slot; only the slot's and the plate's corners are left.
Example slotted() {
  const PolygonMesh minimal =
      shapes::from_lists({{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {3, 3, 0}, {3, 1, 0}, {2, 1, 0}, {2, 3, 0}, {0, 3, 0}},
                         {{0, 1, 4}, {0, 4, 5}, {0, 5, 7}, {5, 6, 7}, {1, 3, 4}, {1, 2, 3}});
  return example(shapes::slotted_plate(2), minimal);
}

/// Two squares at right angles over one edge, from x = 0 to 2.
Example fold() {
  const auto page = [](int n) {
    return shapes::welded(shapes::joined(
        shapes::sheet(2, 2, n, n), shapes::rotated(shapes::turned_over(shapes::sheet(2, 2, n, n)), {1, 0, 0}, 90)));
  };
  return example(shapes::rounded(page(2), 0.5), shapes::rounded(page(1), 0.5));
}

TEST(Verify, correct_claims_are_verified) {
  const std::pair<const char*, Example> all[] = {
      {"cube", cube()},
      {"ring", ring()},
      {"L", flat_l()},
      {"slotted plate", slotted()},
      {"fold", fold()},
      {"box", example(shapes::box({3, 2, 1}, 5), shapes::box({3, 2, 1}, 1))},
      {"quads", example(shapes::quad_box({3, 2, 1}, 1), shapes::box({3, 2, 1}, 1))},
      {"solid L", example(shapes::l_bracket(3), shapes::l_bracket(1))},
      {"two squares that touch",
       example(shapes::two_squares_touching_at_a_vertex(3), shapes::two_squares_touching_at_a_vertex(1))},
      {"cubes that share an edge", example(shapes::blocks({".#", "#."}, 2), shapes::blocks({".#", "#."}, 1))},
      {"three pages", example(shapes::three_pages(3), shapes::three_pages(1))},
      {"double sheet", example(shapes::double_sheet(1), shapes::double_sheet(1))},
      {"cylinder", example(shapes::cylinder(12, 1, 2), shapes::fan_triangulated(shapes::cylinder(12, 1, 2)))},
      {"sphere", example(shapes::sphere(2), shapes::sphere(2))},
      {"inside out",
       example(shapes::turned_over(shapes::box({1, 1, 1}, 2)), shapes::turned_over(shapes::box({1, 1, 1})))},
  };
  for (const auto& [name, e] : all) EXPECT_TRUE(is_verified(e)) << name;
}

TEST(Verify, rounding_noise_of_a_rotation_is_within_tolerance) {
  const auto turned = [](const PolygonMesh& mesh) { return shapes::rotated(mesh, {1, 2, 3}, 40); };
  const Example e = example(turned(shapes::box({3, 2, 1}, 6)), turned(shapes::box({3, 2, 1}, 1)));
  EXPECT_TRUE(is_verified(e));
  EXPECT_LT(e.verify().deviation, 1e-14);
}

TEST(Verify, any_scale_gives_the_same_verdict) {
  const auto turned = [](const PolygonMesh& mesh) { return shapes::rotated(mesh, {1, 2, 3}, 40); };
  const Example correct = example(turned(shapes::ring(4)), turned(shapes::ring(1)));
  for (const double scale : {1e-300, 1e-12, 1e6, 1e38, 1e300}) {
    EXPECT_TRUE(is_verified(scaled(correct, scale))) << scale;
    Example spoiled = scaled(correct, scale);
    spoiled.remove_face(0);
    EXPECT_FALSE(spoiled.verify().surface) << scale;
  }
}

TEST(Verify, renumbering_the_input_changes_nothing) {
  for (unsigned seed = 0; seed < 5; ++seed)
    EXPECT_TRUE(is_verified(example(shapes::renumbered(shapes::l_bracket(3), seed), shapes::l_bracket(1))));
}

TEST(Verify, the_fine_grid_is_decided_exactly_too) {
  Example e = cube();
  for (Frame& frame : e.frames) frame.grid = 0x1p-100;
  e.project();
  EXPECT_TRUE(is_verified(e));
}

// What is wrong with a vertex.

TEST(Verify, a_vertex_moved_by_one_last_place_is_found) {
  Example e = cube();
  Vec3& p = e.positions[e.vertex_at({1, 1, 1}).value];
  p.x = std::nextafter(p.x, 2);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 3u);
}

TEST(Verify, a_negative_zero_is_not_the_same_bits) {
  Example e = cube();
  e.positions[e.vertex_at({0, 0, 0}).value].x = -0.0;
  EXPECT_FALSE(e.verify().surface);
}

TEST(Verify, a_vertex_that_is_not_finite_is_found) {
  Example e = cube();
  e.positions[0].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(e.verify().surface);
}

TEST(Verify, two_output_vertices_at_one_place_are_a_crack) {
  Example e = cube();
  const std::size_t f = 0;
  e.positions.push_back(e.positions[e.faces[f][0].value]);
  e.faces[f][0] = VertexId(e.positions.size() - 1);
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch[f]));
}

// What is wrong with a face.

TEST(Verify, a_missing_face_is_found_wherever_it_is) {
  for (std::size_t f = 0; f < cube().faces.size(); ++f) {
    Example e = cube();
    const PatchId patch = e.face_patch[f];
    e.remove_face(f);
    const Verdict v = e.verify();
    EXPECT_FALSE(v.surface);
    EXPECT_FALSE(v.conforming);
    EXPECT_TRUE(blames(v, patch));
  }
}

TEST(Verify, a_repeated_face_is_found) {
  Example e = cube();
  e.faces.push_back(e.faces[3]);
  e.face_patch.push_back(e.face_patch[3]);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch[3]));
}

TEST(Verify, a_face_turned_over_is_found) {
  Example e = cube();
  std::swap(e.faces[5][0], e.faces[5][1]);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch[5]));
}

TEST(Verify, a_whole_patch_turned_over_with_its_frame_is_found) {
  Example e = cube();
  const PatchId patch = e.face_patch[0];
  for (std::size_t f = 0; f < e.faces.size(); ++f)
    if (e.face_patch[f] == patch) std::swap(e.faces[f][0], e.faces[f][1]);
  Frame& frame = e.frames[patch];
  std::swap(frame.x_axis, frame.y_axis);
  frame.normal = -frame.normal;
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, patch));
}

TEST(Verify, a_face_in_the_wrong_patch_is_found) {
  Example e = cube();
  e.face_patch[0] = e.face_patch.back();
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch.back()));
}

TEST(Verify, two_patches_that_change_places_are_found) {
  Example e = example(shapes::two_squares_touching_at_a_vertex(2), shapes::two_squares_touching_at_a_vertex(1));
  for (PatchId& p : e.face_patch) p = PatchId(1 - static_cast<int>(p.value));
  std::swap(e.frames[PatchId(0)], e.frames[PatchId(1)]);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 2u);
}

TEST(Verify, a_patch_without_faces_is_found) {
  Example e = cube();
  const PatchId patch = e.face_patch[0];
  e.remove_patch(patch);
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(blames(v, patch));
}

TEST(Verify, an_empty_output_is_found) {
  Example e = cube();
  e.faces.clear();
  e.face_patch.clear();
  e.corner_uv.clear();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 6u);
}

/// A square with its middle in the input, so that the output may use it.
Example square_with_middle() {
  const PolygonMesh fan = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}},
                                             {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}});
  return example(fan, fan);
}

TEST(Verify, a_triangle_folded_over_is_found) {
  // The inner vertex is used beyond the square's side: the four triangles' area vectors still add up to the square.
  PolygonMesh input = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1, 0}, {3, 3, 0}, {3, 1, 0}},
                                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 6, 2}, {6, 5, 2}});
  PolygonMesh output = input;
  Example e = example(input, output);
  ASSERT_TRUE(is_verified(e));
  for (Triangle& face : e.faces)
    for (VertexId& v : face)
      if (v == VertexId(4)) v = VertexId(6);
  e.remove_face(4);
  e.remove_face(4);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_FALSE(v.conforming);
}

TEST(Verify, a_fold_inside_sound_loops_is_found_by_orientation_alone) {
  // Two inner vertices that changed places: loops, edges and area vector are as they were.
  const PolygonMesh input = shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 2, 0}, {3, 2, 0}},
                                               {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {3, 0, 4}});
  Example e = example(input, input);
  ASSERT_TRUE(is_verified(e));
  for (Triangle& face : e.faces)
    for (VertexId& v : face)
      if (v.value >= 4) v = VertexId(9 - static_cast<int>(v.value));
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_FALSE(v.surface);
  EXPECT_NE(all_words(v).find("turned over"), std::string::npos);
}

TEST(Verify, a_zero_area_triangle_is_found_though_its_edges_conform) {
  // A middle of the border as an inner vertex: one triangle lies on the border, without area.
  PolygonMesh input =
      shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}}, {{0, 4, 3}, {4, 2, 3}, {4, 1, 2}});
  Example e = example(input, input);
  ASSERT_TRUE(is_verified(e));
  e.add_face(PatchId(0), {0, 0, 0}, {2, 0, 0}, {1, 0, 0});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_NE(all_words(v).find("no area"), std::string::npos);
}

TEST(Verify, a_bow_tie_is_found) {
  Example e = square_with_middle();
  std::swap(e.faces[0][0], e.faces[0][1]);
  std::swap(e.faces[2][0], e.faces[2][1]);
  e.project();
  EXPECT_FALSE(e.verify().conforming);
}

TEST(Verify, a_triangle_of_one_vertex_thrice_is_found) {
  Example e = cube();
  e.faces[0] = {e.faces[0][0], e.faces[0][0], e.faces[0][0]};
  e.project();
  EXPECT_FALSE(e.verify().conforming);
}

// What is wrong with a boundary.

TEST(Verify, the_convex_hull_in_place_of_an_l_is_found) {
  Example e = flat_l();
  e.add_face(PatchId(0), {2, 1, 0}, {1, 2, 0}, {1, 1, 0});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(blames(v, PatchId(0)));
}

TEST(Verify, a_filled_hole_is_found) {
  Example e = ring();
  e.add_face(PatchId(0), {-3, -3, 1}, {3, -3, 1}, {3, 3, 1});
  e.add_face(PatchId(0), {-3, -3, 1}, {3, 3, 1}, {-3, 3, 1});
  EXPECT_FALSE(e.verify().surface);
}

TEST(Verify, a_hole_that_vanished_with_its_vertices_is_found) {
  Example e = ring();
  e.positions.clear();
  e.faces.clear();
  e.face_patch.clear();
  e.add_face(PatchId(0), {-4, -4, 1}, {4, -4, 1}, {4, 4, 1});
  e.add_face(PatchId(0), {-4, -4, 1}, {4, 4, 1}, {-4, 4, 1});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_NE(all_words(v).find("loop"), std::string::npos);
}

TEST(Verify, a_bridged_slot_is_found) {
  Example e = slotted();
  e.add_face(PatchId(0), {2, 1, 0}, {3, 1, 0}, {3, 3, 0});
  e.add_face(PatchId(0), {2, 1, 0}, {3, 3, 0}, {2, 3, 0});
  EXPECT_FALSE(e.verify().surface);
}

TEST(Verify, a_border_joined_across_the_slot_is_found) {
  // The slot's two upper corners are gone: the border runs straight over it, as if it were one.
  Example e = slotted();
  e.positions.clear();
  e.faces.clear();
  e.face_patch.clear();
  e.add_face(PatchId(0), {0, 0, 0}, {5, 0, 0}, {5, 3, 0});
  e.add_face(PatchId(0), {0, 0, 0}, {5, 3, 0}, {0, 3, 0});
  EXPECT_FALSE(e.verify().surface);
}

TEST(Verify, an_edge_divided_on_one_side_only_is_found) {
  Example e = fold();
  ASSERT_TRUE(is_verified(e));
  // (1, 0, 0) is in the middle of the shared edge. Only the lower page uses it.
  const PatchId page = e.patch_at({0, 0, 0}, {2, 0, 0}, {2, 2, 0});
  e.remove_face(e.face_at({0, 0, 0}, {2, 0, 0}, {2, 2, 0}));
  e.add_face(page, {0, 0, 0}, {1, 0, 0}, {2, 2, 0});
  e.add_face(page, {1, 0, 0}, {2, 0, 0}, {2, 2, 0});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_EQ(v.failed_patches.size(), 2u);
}

TEST(Verify, an_edge_divided_on_both_sides_is_fine) {
  Example e = fold();
  const PatchId page = e.patch_at({0, 0, 0}, {2, 0, 0}, {2, 2, 0});
  const PatchId other = PatchId(1 - static_cast<int>(page.value));
  e.remove_patch(page);
  e.remove_patch(other);
  e.add_face(page, {0, 0, 0}, {1, 0, 0}, {0, 2, 0});
  e.add_face(page, {1, 0, 0}, {2, 2, 0}, {0, 2, 0});
  e.add_face(page, {1, 0, 0}, {2, 0, 0}, {2, 2, 0});
  e.add_face(other, {1, 0, 0}, {0, 0, 0}, {0, 0, 2});
  e.add_face(other, {1, 0, 0}, {0, 0, 2}, {2, 0, 2});
  e.add_face(other, {2, 0, 0}, {1, 0, 0}, {2, 0, 2});
  EXPECT_TRUE(is_verified(e));
}

TEST(Verify, a_third_faces_corner_on_a_straight_border_must_stay) {
  // Two pages over the edge x = 0 .. 2, and a fin that stands on its second half.
  const PolygonMesh input = shapes::from_lists(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {2, 0, 2}, {0, 0, 2}, {2, -1, 0}, {1, -1, 0}},
      {{0, 1, 4}, {1, 3, 4}, {1, 2, 3}, {1, 0, 6}, {1, 6, 5}, {2, 1, 5}, {1, 8, 7}, {1, 7, 2}});
  Example e = example(input, input);
  ASSERT_TRUE(is_verified(e));
  const PatchId lower = e.patch_at({1, 0, 0}, {2, 0, 0}, {2, 2, 0});
  const PatchId upper = e.patch_at({1, 0, 0}, {2, 0, 0}, {2, 0, 2});
  e.remove_patch(lower);
  e.remove_patch(upper);
  e.add_face(lower, {0, 0, 0}, {2, 0, 0}, {2, 2, 0});
  e.add_face(lower, {0, 0, 0}, {2, 2, 0}, {0, 2, 0});
  e.add_face(upper, {2, 0, 0}, {0, 0, 0}, {0, 0, 2});
  e.add_face(upper, {2, 0, 0}, {0, 0, 2}, {2, 0, 2});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, lower));
  EXPECT_TRUE(blames(v, upper));
}

TEST(Verify, a_missing_sheet_at_an_edge_of_three_is_found) {
  Example e = example(shapes::three_pages(2), shapes::three_pages(1));
  const PatchId page = e.face_patch[0];
  e.remove_patch(page);
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 3u);  // the others' edge has lost its third face
}

TEST(Verify, one_of_two_equal_sheets_missing_is_found) {
  Example e = example(shapes::double_sheet(2), shapes::double_sheet(2));
  ASSERT_TRUE(is_verified(e));
  e.remove_patch(PatchId(1));
  EXPECT_FALSE(e.verify().conforming);
}

TEST(Verify, a_dropped_boundary_vertex_counts_by_its_distance_from_the_chord) {
  for (const double off : {0.9e-3, 1.1e-3}) {
    const PolygonMesh input =
        shapes::from_lists({{0, 0, 0}, {1, off, 0}, {2, 0, 0}, {1, 2, 0}}, {{0, 1, 3}, {1, 2, 3}});
    const PolygonMesh output = shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {1, 2, 0}}, {{0, 1, 2}});
    Example e = example(input, output);
    e.plane_tolerance = 1e-3;
    const Verdict v = e.verify();
    EXPECT_EQ(v.surface, off < 1e-3) << all_words(v);
    EXPECT_TRUE(v.conforming);
    EXPECT_NEAR(v.deviation, off, 1e-12);
  }
}

TEST(Verify, a_border_that_goes_back_on_itself_is_not_straight) {
  // Through (3, 0) and back to (2, 0): on the line, but not between the ends.
  const PolygonMesh input = shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {2, 1e-4, 0}, {1, 2, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const PolygonMesh output = shapes::from_lists({{0, 0, 0}, {2, 1e-4, 0}, {1, 2, 0}}, {{0, 1, 2}});
  Example e = example(input, output);
  e.plane_tolerance = 1e-3;
  EXPECT_FALSE(e.verify().surface);
}

TEST(Verify, a_vertex_where_patches_touch_must_not_go) {
  // The corner of a tetrahedron touches the middle of a square. Without its middle the square leaves it.
  const PolygonMesh input =
      shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {2, 2, 0}, {2, 1, 1}, {3, 3, 1}, {1, 3, 1}},
                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {4, 6, 5}, {4, 7, 6}, {4, 5, 7}, {5, 6, 7}});
  Example e = example(input, input);
  ASSERT_TRUE(is_verified(e));
  const PatchId square = e.face_patch[0];
  e.remove_patch(square);
  e.add_face(square, {0, 0, 0}, {4, 0, 0}, {4, 4, 0});
  e.add_face(square, {0, 0, 0}, {4, 4, 0}, {0, 4, 0});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_EQ(v.failed_patches, std::vector<PatchId>{square});
}

TEST(Verify, an_interior_edge_that_two_patches_share_is_found) {
  // Both sheets of a pillow cut along the same diagonal: the edge has four faces.
  Example e = example(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}, {3, 2, 1, 0}}),
                      shapes::double_sheet(1));
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_EQ(v.failed_patches.size(), 2u);
}

// What is wrong with a distance.

/// A square of 4 x 4 cells whose vertex (1, 1) is lifted; four corners are left.
Example bump(double height, double plane_tolerance) {
  PolygonMesh input = shapes::sheet(4, 4, 4, 4);
  const PolygonMesh output = shapes::sheet(4, 4, 1, 1);
  Example e = example(input, output);
  for (Vec3& p : e.surface.positions)
    if (p == Vec3{1, 1, 0}) p.z = height;
  e.plane_tolerance = plane_tolerance;
  return e;
}

TEST(Verify, an_inner_vertex_off_the_plane_counts_by_its_distance) {
  EXPECT_TRUE(is_verified(bump(0.9e-3, 1e-3)));
  EXPECT_NEAR(bump(0.9e-3, 1e-3).verify().deviation, 0.9e-3, 1e-12);
  const Verdict v = bump(1.1e-3, 1e-3).verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(v.conforming && v.delaunay);
  EXPECT_EQ(v.failed_patches, std::vector<PatchId>{PatchId(0)});
}

/// A slope of 1 : 2000 in a frame that calls it level: heights over the plane go up to four tolerances, and say
/// nothing. The vertex (1, 1) is lifted off the slope.
Example slope(double lift) {
  const auto tilted = [](PolygonMesh mesh) {
    for (Vec3& p : mesh.positions) p.z = 0.5e-3 * p.x;
    return mesh;
  };
  Example e = example(tilted(shapes::flat({"####", "#.##", "####", "####"}, 3)),
                      tilted(shapes::flat({"####", "#.##", "####", "####"})));
  for (Vec3& p : e.surface.positions)
    if (p == Vec3{1 / 3.0, 2 / 3.0, 0.5e-3 / 3}) p.z += lift;
  e.frames[PatchId(0)] = {{2, 2, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 4, 0x1p-40};
  e.project();
  e.make_delaunay();
  e.plane_tolerance = 0.5e-3;
  return e;
}

TEST(Verify, where_heights_prove_nothing_distances_are_measured) {
  EXPECT_TRUE(is_verified(slope(0)));
  EXPECT_LT(slope(0).verify().deviation, 1e-12);
  for (const double sign : {-1.0, 1.0}) {
    EXPECT_TRUE(is_verified(slope(sign * 0.4e-3)));
    EXPECT_NEAR(slope(sign * 0.4e-3).verify().deviation, 0.4e-3, 1e-12);
    EXPECT_FALSE(slope(sign * 0.6e-3).verify().surface);
  }
}

TEST(Verify, measured_distances_are_the_true_ones) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    PolygonMesh output = shapes::rotated(shapes::noisy_sheet(12, seed), {0, 0, 1}, 7.0 * seed);
    for (Vec3& p : output.positions) p.z = 1e-2 * unit(random);
    // In every output triangle the input has one vertex more, a known bit above or below it.
    PolygonMesh input;
    input.positions = output.positions;
    double largest = 0;
    for (std::size_t f = 0; f < output.face_count(); ++f) {
      const auto face = output.face(FaceId(f));
      const double s = 0.4 + 0.3 * unit(random), t = (1 - s) * (0.5 + 0.4 * unit(random));
      Vec3 p = s * input.positions[face[0]] + t * input.positions[face[1]] + (1 - s - t) * input.positions[face[2]];
      const double lift = 1e-3 * unit(random);
      p.z += lift;
      largest = std::max(largest, std::fabs(lift));
      const VertexId middle = input.positions.push_back(p);
      for (int i = 0; i < 3; ++i) {
        for (const VertexId v : {face[i], face[(i + 1) % 3], middle}) input.corners.push_back(v);
        input.face_begin.push_back(static_cast<std::uint32_t>(input.corners.size()));
      }
    }
    Example e;
    e.surface = shapes::surface(input);
    e.surface_patch.assign(input.face_count(), PatchId(0));
    e.frames.push_back({{6, 6, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 32, 0x1p-40});
    e.positions = output.positions.items();
    e.faces = shapes::triangles(output).faces.items();
    e.face_patch.assign(e.faces.size(), PatchId(0));
    e.project();
    e.plane_tolerance = largest * 1.001;
    EXPECT_TRUE(e.verify().surface) << all_words(e.verify());
    EXPECT_NEAR(e.verify().deviation, largest, 1e-9);
    e.plane_tolerance = largest * 0.999;
    EXPECT_FALSE(e.verify().surface);
  }
}

TEST(Verify, an_input_that_folds_over_inside_the_plane_is_found) {
  // An inner vertex pulled over the border: the flap beyond it has no output, though loops and planes agree.
  Example e = bump(0, 1e-3);
  for (Vec3& p : e.surface.positions)
    if (p == Vec3{1, 1, 0}) p = {1, -1, 0};
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
}

TEST(Verify, noise_of_the_input_may_turn_slivers_over) {
  Example e = example(shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1e-12, 0}},
                                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
                      shapes::sheet(2, 2, 1, 1));
  e.surface.positions[VertexId(4)].y = -1e-12;
  EXPECT_TRUE(is_verified(e));
}

TEST(Verify, an_unchanged_triangle_is_not_held_against_its_plane) {
  // A needle whose normal is noise: kept as it is, with a frame that shows it edge on.
  const PolygonMesh needle = shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-14, 0}}, {{0, 1, 2}});
  Example e = example(needle, needle);
  Frame& frame = e.frames[PatchId(0)];
  frame.normal = {0, 1, 0};
  frame.x_axis = {0, 0, 1};
  frame.y_axis = {1, 0, 0};
  e.project();
  EXPECT_TRUE(is_verified(e));
}

// What is wrong in the plane.

/// A kite: its Delaunay diagonal is the short one.
Example kite() {
  const PolygonMesh input = shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{0, 1, 2, 3}});
  const PolygonMesh output = shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
  return example(input, output);
}

TEST(Verify, the_wrong_diagonal_is_found) {
  Example e = kite();
  ASSERT_TRUE(is_verified(e));
  e.faces = {{VertexId(0), VertexId(1), VertexId(3)}, {VertexId(1), VertexId(2), VertexId(3)}};
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.delaunay);
  EXPECT_TRUE(v.surface && v.conforming);
  EXPECT_EQ(v.failed_patches, std::vector<PatchId>{PatchId(0)});
}

TEST(Verify, the_wrong_diagonal_is_right_where_the_right_one_is_taken) {
  // Under the kite hangs a triangle that has the short diagonal as its edge.
  const std::vector<Vec3> points{{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}, {0, 0, -1}};
  Example e = example(shapes::from_lists(points, {{0, 1, 2, 3}, {0, 2, 4}}),
                      shapes::from_lists(points, {{0, 1, 3}, {1, 2, 3}, {0, 2, 4}}));
  EXPECT_FALSE(e.verify().conforming);  // made Delaunay, the kite takes the triangle's edge
  e.faces[0] = {VertexId(0), VertexId(1), VertexId(3)};
  e.faces[1] = {VertexId(1), VertexId(2), VertexId(3)};
  e.project();
  EXPECT_TRUE(is_verified(e));
}

TEST(Verify, a_diagonal_wrong_by_the_last_place_of_the_grid_is_found) {
  // The square's upper right corner lies on the circle of the others, or one step inside.
  for (const bool is_inside : {false, true}) {
    const double y = is_inside ? 1 - 0x1p-39 : 1;
    const PolygonMesh square =
        shapes::from_lists({{-1, -1, 0}, {1, -1, 0}, {1, y, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
    Example e = example(square, square);
    e.frames[PatchId(0)] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 2, 0x1p-40};
    e.faces = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(0), VertexId(2), VertexId(3)}};
    e.project();
    EXPECT_TRUE(e.verify().delaunay);
    e.faces = {{VertexId(0), VertexId(1), VertexId(3)}, {VertexId(1), VertexId(2), VertexId(3)}};
    e.project();
    EXPECT_EQ(e.verify().delaunay, !is_inside);
  }
}

TEST(Verify, a_plane_coordinate_off_by_one_step_is_found) {
  for (std::size_t corner = 0; corner < 36; ++corner) {
    Example e = cube();
    e.corner_uv[corner].x += e.corner_uv[corner].x > 0 ? -0x1p-40 : 0x1p-40;
    const Verdict v = e.verify();
    EXPECT_FALSE(v.delaunay);
    EXPECT_EQ(v.failed_patches, std::vector<PatchId>{e.face_patch[corner / 3]});
  }
}

TEST(Verify, a_plane_coordinate_off_the_grid_is_found) {
  Example e = cube();
  e.corner_uv[7].y += 0x1p-42;
  EXPECT_FALSE(e.verify().delaunay);
  e.corner_uv[7].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(e.verify().delaunay);
}

TEST(Verify, a_frame_that_is_none_is_found) {
  const std::function<void(Frame&)> spoil[] = {[](Frame& f) { f.normal = 1.001 * f.normal; },
                                               [](Frame& f) { f.normal = -f.normal; },
                                               [](Frame& f) { f.x_axis = f.y_axis; },
                                               [](Frame& f) { f.scale *= 1.5; },
                                               [](Frame& f) { f.grid = 0; },
                                               [](Frame& f) { f.origin.x = std::nan(""); }};
  for (const auto& change : spoil) {
    Example e = cube();
    change(e.frames[PatchId(2)]);
    const Verdict v = e.verify();
    EXPECT_FALSE(v.delaunay);
    EXPECT_TRUE(blames(v, PatchId(2)));
  }
}

// Anything else.

TEST(Verify, no_single_change_of_a_face_goes_unseen) {
  for (const Example& correct : {cube(), ring(), flat_l(), slotted(), square_with_middle()}) {
    for (std::size_t f = 0; f < correct.faces.size(); ++f) {
      for (int corner = 0; corner < 3; ++corner)
        for (std::size_t v = 0; v < correct.positions.size(); ++v) {
          if (correct.faces[f][corner] == VertexId(v)) continue;
          Example e = correct;
          e.faces[f][corner] = VertexId(v);
          e.project();
          EXPECT_FALSE(e.verify().all_true()) << "face " << f << " corner " << corner << " vertex " << v;
        }
      for (std::size_t p = 0; p < correct.frames.size(); ++p) {
        if (correct.face_patch[f] == PatchId(p)) continue;
        Example e = correct;
        e.face_patch[f] = PatchId(p);
        e.project();
        EXPECT_FALSE(e.verify().all_true()) << "face " << f << " patch " << p;
      }
    }
    for (std::size_t a = 0; a < correct.positions.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        Example e = correct;
        std::swap(e.positions[a], e.positions[b]);
        e.project();
        EXPECT_FALSE(e.verify().all_true()) << "vertices " << a << " and " << b;
      }
  }
}

// The claim itself.

TEST(Verify, a_claim_that_does_not_fit_together_fails_as_a_whole) {
  const std::function<void(Example&)> spoil[] = {
      [](Example& e) { e.face_patch.pop_back(); },
      [](Example& e) { e.corner_uv.pop_back(); },
      [](Example& e) { e.face_patch[0] = PatchId(); },
      [](Example& e) { e.faces[0][1] = VertexId(1000); },
      [](Example& e) { e.surface_patch[FaceId(0)] = PatchId(6); },
      [](Example& e) { e.frames.items().pop_back(); },
  };
  for (const auto& change : spoil) {
    Example e = cube();
    change(e);
    const Verdict v = e.verify();
    EXPECT_FALSE(v.surface || v.conforming || v.delaunay);
    EXPECT_FALSE(v.failures.empty());
  }
}

TEST(Verify, gives_the_same_verdict_for_any_number_of_threads) {
  Example e = example(shapes::renumbered(shapes::box({3, 2, 1}, 12), 1), shapes::box({3, 2, 1}, 4));
  for (std::size_t f = e.faces.size(); f-- > 0;)
    if (f % 7 == 0) e.remove_face(f);
  std::vector<Verdict> verdicts;
  for (const std::size_t threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    verdicts.push_back(e.verify());
  }
  EXPECT_FALSE(verdicts[0].surface);
  for (const Verdict& v : verdicts) {
    EXPECT_EQ(v.failures, verdicts[0].failures);
    EXPECT_EQ(v.failed_patches, verdicts[0].failed_patches);
    EXPECT_EQ(v.deviation, verdicts[0].deviation);
  }
}

TEST(Verify, stops_when_asked) {
  const Example e = cube();
  RunControl control;
  control.cancel();
  const Claim claim{e.surface, e.surface_patch, e.frames,    e.positions,
                    e.faces,   e.face_patch,    e.corner_uv, e.plane_tolerance};
  EXPECT_THROW(verify(claim, control), Error);
}

}  // namespace
}  // namespace remesh
