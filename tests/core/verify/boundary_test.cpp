#include <gtest/gtest.h>

#include "tests/core/verify/cases.h"

namespace remesh {
namespace {

TEST(verify, the_convex_hull_in_place_of_an_l_is_found) {
  Example e = flat_l();
  e.add_face(PatchId(0), {2, 1, 0}, {1, 2, 0}, {1, 1, 0});
  const Verdict v = e.verify();
  EXPECT_FALSE(v.surface);
  EXPECT_TRUE(blames(v, PatchId(0)));
}

TEST(verify, a_filled_hole_is_found) {
  Example e = ring();
  e.add_face(PatchId(0), {-3, -3, 1}, {3, -3, 1}, {3, 3, 1});
  e.add_face(PatchId(0), {-3, -3, 1}, {3, 3, 1}, {-3, 3, 1});
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, a_hole_that_vanished_with_its_vertices_is_found) {
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

TEST(verify, a_bridged_slot_is_found) {
  Example e = slotted();
  e.add_face(PatchId(0), {2, 1, 0}, {3, 1, 0}, {3, 3, 0});
  e.add_face(PatchId(0), {2, 1, 0}, {3, 3, 0}, {2, 3, 0});
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, a_border_joined_across_the_slot_is_found) {
  // The slot's two upper corners are gone: the border runs straight over it, as if it were one.
  Example e = slotted();
  e.positions.clear();
  e.faces.clear();
  e.face_patch.clear();
  e.add_face(PatchId(0), {0, 0, 0}, {5, 0, 0}, {5, 3, 0});
  e.add_face(PatchId(0), {0, 0, 0}, {5, 3, 0}, {0, 3, 0});
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, an_edge_divided_on_one_side_only_is_found) {
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

TEST(verify, an_edge_divided_on_both_sides_is_fine) {
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

TEST(verify, a_third_faces_corner_on_a_straight_border_must_stay) {
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

TEST(verify, a_missing_sheet_at_an_edge_of_three_is_found) {
  Example e = example(shapes::three_pages(2), shapes::three_pages(1));
  const PatchId page = e.face_patch[0];
  e.remove_patch(page);
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_FALSE(v.surface);
  EXPECT_EQ(v.failed_patches.size(), 3u);  // the others' edge has lost its third face
}

TEST(verify, one_of_two_equal_sheets_missing_is_found) {
  Example e = example(shapes::double_sheet(2), shapes::double_sheet(2));
  e.allow_intersections();
  ASSERT_TRUE(is_verified(e));
  e.remove_patch(PatchId(1));
  EXPECT_FALSE(e.verify().conforming);
}

TEST(verify, a_dropped_boundary_vertex_counts_by_its_distance_from_the_chord) {
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

TEST(verify, a_border_that_goes_back_on_itself_is_not_straight) {
  // Through (3, 0) and back to (2, 0): on the line, but not between the ends.
  const PolygonMesh input = shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {2, 1e-4, 0}, {1, 2, 0}}, {{0, 1, 2}, {0, 2, 3}});
  const PolygonMesh output = shapes::from_lists({{0, 0, 0}, {2, 1e-4, 0}, {1, 2, 0}}, {{0, 1, 2}});
  Example e = example(input, output);
  e.plane_tolerance = 1e-3;
  EXPECT_FALSE(e.verify().surface);
}

TEST(verify, a_vertex_where_patches_touch_must_not_go) {
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
  e.allow_intersections();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_EQ(v.failed_patches, std::vector<PatchId>{square});
}

TEST(verify, an_interior_edge_that_two_patches_share_is_found) {
  // Both sheets of a pillow cut along the same diagonal: the edge has four faces.
  Example e = example(shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}, {3, 2, 1, 0}}),
                      shapes::double_sheet(1));
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_EQ(v.failed_patches.size(), 2u);
}
}  // namespace
}  // namespace remesh
