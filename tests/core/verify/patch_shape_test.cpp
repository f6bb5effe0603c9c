#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <utility>

#include "tests/core/verify/cases.h"

namespace remesh {
namespace {

TEST(verify, a_missing_face_is_found_wherever_it_is) {
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

TEST(verify, a_repeated_face_is_found) {
  Example e = cube();
  e.faces.push_back(e.faces[3]);
  e.face_patch.push_back(e.face_patch[3]);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch[3]));
}

TEST(verify, a_face_turned_over_is_found) {
  Example e = cube();
  std::swap(e.faces[5][0], e.faces[5][1]);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch[5]));
}

TEST(verify, a_whole_patch_turned_over_with_its_frame_is_found) {
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

TEST(verify, a_face_in_the_wrong_patch_is_found) {
  Example e = cube();
  e.face_patch[0] = e.face_patch.back();
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(blames(v, e.face_patch.back()));
}

TEST(verify, two_patches_that_change_places_are_found) {
  Example e = example(shapes::two_squares_touching_at_a_vertex(2), shapes::two_squares_touching_at_a_vertex(1));
  for (PatchId& p : e.face_patch) p = PatchId(1 - static_cast<int>(p.value));
  std::swap(e.frames[PatchId(0)], e.frames[PatchId(1)]);
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 2u);
}

TEST(verify, a_patch_without_faces_is_found) {
  Example e = cube();
  const PatchId patch = e.face_patch[0];
  e.remove_patch(patch);
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(blames(v, patch));
}

TEST(verify, an_empty_output_is_found) {
  Example e = cube();
  e.faces.clear();
  e.face_patch.clear();
  e.corner_uv.clear();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 6u);
}

TEST(verify, a_triangle_folded_over_is_found) {
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

TEST(verify, a_fold_inside_sound_loops_is_found_by_orientation_alone) {
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

TEST(verify, a_zero_area_triangle_is_found_though_its_edges_conform) {
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

TEST(verify, a_bow_tie_is_found) {
  Example e = square_with_middle();
  std::swap(e.faces[0][0], e.faces[0][1]);
  std::swap(e.faces[2][0], e.faces[2][1]);
  e.project();
  EXPECT_FALSE(e.verify().conforming);
}

TEST(verify, a_triangle_of_one_vertex_thrice_is_found) {
  Example e = cube();
  e.faces[0] = {e.faces[0][0], e.faces[0][0], e.faces[0][0]};
  e.project();
  EXPECT_FALSE(e.verify().conforming);
}

TEST(verify, an_inner_vertex_off_the_plane_counts_by_its_distance) {
  EXPECT_TRUE(is_verified(bump(0.9e-3, 1e-3)));
  EXPECT_NEAR(bump(0.9e-3, 1e-3).verify().deviation, 0.9e-3, 1e-12);
  const Verdict v = bump(1.1e-3, 1e-3).verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(v.conforming && v.delaunay);
  EXPECT_EQ(v.failed_patches, std::vector<PatchId>{PatchId(0)});
}

TEST(verify, an_input_that_folds_over_inside_the_plane_is_found) {
  // An inner vertex pulled over the border: the flap beyond it has no output, though loops and planes agree.
  Example e = bump(0, 1e-3);
  e.move([](Vec3& p) {
    if (p == Vec3{1, 1, 0}) p = {1, -1, 0};
  });
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
}

TEST(verify, noise_of_the_input_may_turn_slivers_over) {
  Example e = example(shapes::from_lists({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 1e-12, 0}},
                                         {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}),
                      shapes::sheet(2, 2, 1, 1));
  e.move([](Vec3& p) {
    if (p == Vec3{1, 1e-12, 0}) p.y = -1e-12;
  });
  EXPECT_TRUE(is_verified(e));
}

TEST(verify, an_unchanged_triangle_is_not_held_against_its_plane) {
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
}  // namespace
}  // namespace remesh
