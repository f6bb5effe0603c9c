#include "core/verify/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>

#include "tests/core/verify/cases.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

TEST(verify, correct_claims_are_verified) {
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
      {"cylinder", example(shapes::cylinder(12, 1, 2), shapes::fan_triangulated(shapes::cylinder(12, 1, 2)))},
      {"sphere", example(shapes::sphere(2), shapes::sphere(2))},
      {"pyramid", pyramid()},
      {"inside out",
       example(shapes::turned_over(shapes::box({1, 1, 1}, 2)), shapes::turned_over(shapes::box({1, 1, 1})))},
  };
  for (const auto& [name, e] : all) EXPECT_TRUE(is_verified(e)) << name;
}

TEST(verify, faces_may_intersect_only_where_their_patches_do_in_the_input) {
  // Each face lies on its back, and is a patch of its own.
  Example e = example(split_in_three(shapes::double_sheet(1)), shapes::double_sheet(1));
  const Verdict v = e.verify();
  EXPECT_FALSE(v.conforming);
  EXPECT_TRUE(v.surface && v.delaunay);
  EXPECT_EQ(v.failed_patches.size(), 4u);
  ASSERT_EQ(v.intersections.size(), 2u);
  const auto patches = [&](std::size_t pair) {
    const auto& [f, g] = v.intersections[pair];
    return std::pair(std::minmax(e.face_patch[f.value], e.face_patch[g.value]));
  };
  e.intersecting_patches = {patches(0)};
  EXPECT_EQ(e.verify().failed_patches, (std::vector<PatchId>{patches(1).first, patches(1).second}));
  e.intersecting_patches = {patches(0), patches(1)};
  std::sort(e.intersecting_patches.begin(), e.intersecting_patches.end());
  EXPECT_TRUE(is_verified(e));
}

TEST(verify, triangles_of_the_input_meet_nowhere_for_the_first_time) {
  const PolygonMesh crossing =
      shapes::joined(shapes::sheet(1, 1, 1, 1),
                     shapes::moved(shapes::rotated(shapes::sheet(1, 1, 1, 1), {1, 1, 0}, 90), {0.25, 0.25, 0}));
  Example unchanged = example(crossing, crossing);
  EXPECT_TRUE(is_verified(unchanged));
  // A sheet of its own beside them has changed, and meets none of them.
  Example beside = example(shapes::joined(crossing, shapes::moved(shapes::sheet(1, 1, 2, 2), {5, 0, 0})),
                           shapes::joined(crossing, shapes::moved(shapes::sheet(1, 1, 1, 1), {5, 0, 0})));
  EXPECT_TRUE(is_verified(beside));
  // If the sheets have changed, their triangles are new, and nobody claims that they cross.
  EXPECT_FALSE(example(split_in_three(crossing), crossing).verify().conforming);
}

TEST(verify, it_tells_where_intersections_are_too_many_to_be_all_known) {
  Example few = example(split_in_three(shapes::double_sheet(1)), shapes::double_sheet(1));
  few.allow_intersections();
  EXPECT_TRUE(few.verify().are_all_intersections_known);
  few.are_these_all = false;
  EXPECT_TRUE(few.verify().conforming);
  EXPECT_FALSE(few.verify().are_all_intersections_known);
  // Sheets a little askew, each through all others.
  PolygonMesh sheets;
  for (int i = 0; i < 330; ++i) {
    const PolygonMesh sheet =
        shapes::rotated(shapes::moved(shapes::sheet(2, 2, 1, 1), {-1, -1, 0}), {1, 0, 0}, 0.5 * i);
    sheets = i == 0 ? sheet : shapes::joined(sheets, sheet);
  }
  const Verdict many = example(split_in_three(sheets), sheets).verify();
  EXPECT_FALSE(many.conforming);
  EXPECT_FALSE(many.are_all_intersections_known);
  EXPECT_LT(many.intersections.size(), 10'000u) << "a result that has failed needs no list of them all";
  EXPECT_EQ(many.failed_patches.size(), 330u) << "but most patches show";
}

TEST(verify, rounding_noise_of_a_rotation_is_within_tolerance) {
  const auto turned = [](const PolygonMesh& mesh) { return shapes::rotated(mesh, {1, 2, 3}, 40); };
  const Example e = example(turned(shapes::box({3, 2, 1}, 6)), turned(shapes::box({3, 2, 1}, 1)));
  EXPECT_TRUE(is_verified(e));
  EXPECT_LT(e.verify().deviation, 1e-14);
}

TEST(verify, any_scale_gives_the_same_verdict) {
  const auto turned = [](const PolygonMesh& mesh) { return shapes::rotated(mesh, {1, 2, 3}, 40); };
  const Example correct = example(turned(shapes::ring(4)), turned(shapes::ring(1)));
  for (const double scale : {1e-300, 1e-12, 1e6, 1e38, 1e300}) {
    EXPECT_TRUE(is_verified(scaled(correct, scale))) << scale;
    Example spoiled = scaled(correct, scale);
    spoiled.remove_face(0);
    EXPECT_FALSE(spoiled.verify().surface) << scale;
  }
}

TEST(verify, renumbering_the_input_changes_nothing) {
  for (unsigned seed = 0; seed < 5; ++seed)
    EXPECT_TRUE(is_verified(example(shapes::renumbered(shapes::l_bracket(3), seed), shapes::l_bracket(1))));
}

TEST(verify, the_fine_grid_is_decided_exactly_too) {
  Example e = cube();
  for (Frame& frame : e.frames) frame.grid = 0x1p-100;
  e.project();
  EXPECT_TRUE(is_verified(e));
}

TEST(verify, plane_coordinates_may_be_off_by_one_of_the_fine_grid_and_by_no_more) {
  for (const int units : {-2, -1, 1, 2}) {
    const PolygonMesh rhombus =
        shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
    Example e = example(rhombus, rhombus);
    Frame& frame = e.frames[PatchId(0)];
    frame.grid = 0x1p-100;
    const VertexId alone(1);                  // the other triangle does not have this corner
    frame.origin = e.positions[alone.value];  // there nothing is rounded otherwise
    e.project();
    ASSERT_TRUE(is_verified(e));
    for (std::size_t i = 0; i < 6; ++i)
      if (e.faces[i / 3][i % 3] == alone) e.corner_uv[i].y += units * 0x1p-100;
    EXPECT_EQ(is_verified(e), std::abs(units) == 1) << units;
  }
}

// The next tests are about faults in the plane.

/// Makes a kite, of which the Delaunay diagonal is the short one.
Example kite() {
  const PolygonMesh input = shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{0, 1, 2, 3}});
  const PolygonMesh output = shapes::from_lists({{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
  return example(input, output);
}

TEST(verify, the_wrong_diagonal_is_found) {
  Example e = kite();
  ASSERT_TRUE(is_verified(e));
  e.faces = {{VertexId(0), VertexId(1), VertexId(3)}, {VertexId(1), VertexId(2), VertexId(3)}};
  e.project();
  const Verdict v = e.verify();
  EXPECT_FALSE(v.delaunay);
  EXPECT_TRUE(v.surface && v.conforming);
  EXPECT_EQ(v.failed_patches, std::vector<PatchId>{PatchId(0)});
}

TEST(verify, the_wrong_diagonal_is_right_where_the_right_one_is_taken) {
  // Under the kite hangs a triangle that has the short diagonal as its edge.
  const std::vector<Vec3> points{{0, -1, 0}, {3, 0, 0}, {0, 1, 0}, {-3, 0, 0}, {0, 0, -1}};
  Example e = example(shapes::from_lists(points, {{0, 1, 2, 3}, {0, 2, 4}}),
                      shapes::from_lists(points, {{0, 1, 3}, {1, 2, 3}, {0, 2, 4}}));
  EXPECT_FALSE(e.verify().conforming);  // made Delaunay, the kite takes the triangle's edge
  e.faces[0] = {VertexId(0), VertexId(1), VertexId(3)};
  e.faces[1] = {VertexId(1), VertexId(2), VertexId(3)};
  e.intersecting_patches = {{PatchId(0), PatchId(1)}};  // the kite holds the triangle's edge, whatever its diagonal
  e.project();
  EXPECT_TRUE(is_verified(e));
}

TEST(verify, a_diagonal_wrong_by_the_last_place_of_the_grid_is_found) {
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

TEST(verify, a_plane_coordinate_off_by_one_step_is_found) {
  for (std::size_t corner = 0; corner < 36; ++corner) {
    Example e = cube();
    e.corner_uv[corner].x += e.corner_uv[corner].x > 0 ? -0x1p-40 : 0x1p-40;
    const Verdict v = e.verify();
    EXPECT_FALSE(v.delaunay);
    EXPECT_EQ(v.failed_patches, std::vector<PatchId>{e.face_patch[corner / 3]});
  }
}

TEST(verify, a_plane_coordinate_off_the_grid_is_found) {
  Example e = cube();
  e.corner_uv[7].y += 0x1p-42;
  EXPECT_FALSE(e.verify().delaunay);
  e.corner_uv[7].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(e.verify().delaunay);
}

TEST(verify, a_frame_that_is_none_is_found) {
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

TEST(verify, only_triangles_that_are_kept_need_no_frame) {
  const Example correct = pyramid();
  ASSERT_EQ(correct.frames.size(), 5u);
  for (std::uint32_t p = 0; p < 5; ++p) {
    Example e = correct;
    e.frame_of_patch = {0, 1, 2, 3, 4};
    e.frame_of_patch[p] = kNone;
    const bool is_base = correct.frames[PatchId(p)].normal.z < -0.9;
    const Verdict v = e.verify();
    EXPECT_EQ(v.all_true(), !is_base) << p;
    EXPECT_EQ(blames(v, PatchId(p)), is_base) << p;
    // The side is kept no longer if its output has another vertex.
    if (is_base) continue;
    e.positions.push_back({1, 1, 1.25});
    for (std::size_t f = 0; f < e.faces.size(); ++f)
      if (e.face_patch[f] == PatchId(p)) e.faces[f][2] = VertexId(5);
    EXPECT_TRUE(blames(e.verify(), PatchId(p))) << p;
  }
}

// Anything else.

TEST(verify, no_single_change_of_a_face_goes_unseen) {
  for (const Example& correct : {cube(), ring(), flat_l(), slotted(), square_with_middle(), pyramid()}) {
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

TEST(verify, a_claim_that_does_not_fit_together_fails_as_a_whole) {
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

STAGE(verify, test::kWorkers, test::kStop) {
  Example e = example(shapes::renumbered(shapes::box({3, 2, 1}, 12), 1), shapes::box({3, 2, 1}, 4));
  for (std::size_t f = e.faces.size(); f-- > 0;)
    if (f % 7 == 0) e.remove_face(f);
  const Verdict verdict = e.verify(trial.control);
  EXPECT_FALSE(verdict.surface);
  trial.in_order(verdict.failures, verdict.failed_patches, verdict.deviation);
}

}  // namespace
}  // namespace remesh
