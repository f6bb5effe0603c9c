#include "core/verify/polygons/polygon_cover_check.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/core/verify/example.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// Returns the verdict on triangles that are made from the first face of a mesh. They are taken both for the surface
/// and for the result.
Verdict verdict_on(const PolygonMesh& input, const PolygonMesh& triangles, double weld_tolerance = 0) {
  Example e = example(triangles, triangles);
  for (FaceId& source : e.surface.face_source) source = FaceId(0);
  e.allow_intersections();
  e.input = &input;
  e.weld_tolerance = weld_tolerance;
  return e.verify();
}

bool is_refuted(const Verdict& verdict) {
  return std::any_of(verdict.failures.begin(), verdict.failures.end(),
                     [](const std::string& failure) { return failure.find("input polygon 0") != std::string::npos; });
}

/// Returns the given triangles over a polygon's own corners.
PolygonMesh cut_into(const PolygonMesh& polygon, const std::vector<std::vector<std::uint32_t>>& triangles) {
  return shapes::from_lists(polygon.positions.items(), triangles);
}

TEST(check_polygons, triangles_that_cover_a_polygon_once_are_right) {
  const PolygonMesh l = shapes::polygon({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
  EXPECT_FALSE(is_refuted(verdict_on(l, cut_into(l, {{0, 1, 3}, {1, 2, 3}, {0, 3, 5}, {3, 4, 5}}))));
}

TEST(check_polygons, a_fan_over_a_concave_polygon_is_found) {
  const PolygonMesh l = shapes::polygon({{0, 0}, {2, 0}, {2, 1}, {0.25, 1}, {1, 3}, {0, 2}});
  const Verdict verdict = verdict_on(l, cut_into(l, {{1, 2, 3}, {1, 3, 4}, {1, 4, 5}, {1, 5, 0}}));
  EXPECT_TRUE(is_refuted(verdict));
  EXPECT_FALSE(verdict.surface);
}

TEST(check_polygons, a_triangle_that_is_missing_is_found) {
  const PolygonMesh square = shapes::polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  EXPECT_TRUE(is_refuted(verdict_on(square, shapes::from_lists({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 1, 2}}))));
}

TEST(check_polygons, a_polygon_that_crosses_itself_has_no_right_triangles) {
  const PolygonMesh tie = shapes::polygon({{0, 0}, {3, 1}, {3, 0}, {0, 2}});
  EXPECT_FALSE(is_refuted(verdict_on(tie, cut_into(tie, {{0, 1, 2}, {0, 2, 3}}))));
}

TEST(check_polygons, a_fan_that_covers_a_spike_twice_is_found) {
  // The spike runs out from (6, 3) and back, and the fan from the corner (0, 0) has it in two triangles.
  const PolygonMesh spiked =
      shapes::from_lists({{0, 0, 0}, {10, 0, 0}, {10, 3, 0}, {6, 3, 0}, {7, 5, 0}, {0, 3, 0}}, {{0, 1, 2, 3, 4, 3, 5}});
  EXPECT_TRUE(
      is_refuted(verdict_on(spiked, cut_into(spiked, {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 3}, {0, 3, 5}}))));
  EXPECT_FALSE(is_refuted(verdict_on(spiked, cut_into(spiked, {{0, 1, 2}, {0, 2, 5}}))));
}

TEST(check_polygons, a_tent_over_a_spike_that_leaves_the_plane_is_found) {
  for (const Vec3& tip : {Vec3{5, 2, 1}, {5, 2, 0.01}, {6, 3, 1}, {7, 5, 1}}) {
    const PolygonMesh spiked =
        shapes::from_lists({{0, 0, 0}, {10, 0, 0}, {10, 3, 0}, {6, 3, 0}, tip, {0, 3, 0}}, {{0, 1, 2, 3, 4, 3, 5}});
    EXPECT_TRUE(
        is_refuted(verdict_on(spiked, cut_into(spiked, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {4, 3, 5}, {0, 4, 5}}))))
        << tip.x << ' ' << tip.z;
    EXPECT_FALSE(is_refuted(verdict_on(spiked, cut_into(spiked, {{0, 1, 2}, {0, 2, 5}})))) << tip.x << ' ' << tip.z;
  }
}

TEST(check_polygons, a_slit_in_the_plane_may_be_in_the_triangles) {
  const PolygonMesh slit =
      shapes::from_lists({{0, 0, 0}, {10, 0, 0}, {10, 3, 0}, {6, 3, 0}, {5, 2, 0}, {0, 3, 0}}, {{0, 1, 2, 3, 4, 3, 5}});
  EXPECT_FALSE(is_refuted(verdict_on(slit, cut_into(slit, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {4, 3, 5}, {0, 4, 5}}))));
}

TEST(check_polygons, a_polygon_that_touches_its_own_edge_is_not_judged) {
  const PolygonMesh touching = shapes::polygon({{0, 1}, {0, 0}, {1, 1}, {1, 0}, {2, 1}});
  EXPECT_FALSE(is_refuted(verdict_on(touching, cut_into(touching, {{1, 2, 3}, {1, 3, 4}, {1, 4, 0}}))));
}

TEST(check_polygons, a_polygon_that_takes_one_way_twice_is_not_judged) {
  const PolygonMesh twice = shapes::from_lists({{2, 1, 0}, {1, 2, 1}, {2, 2, 1}, {1, 2, 0}}, {{0, 1, 2, 0, 1, 3}});
  EXPECT_FALSE(is_refuted(verdict_on(twice, cut_into(twice, {{0, 1, 3}}))));
}

TEST(check_polygons, parts_that_meet_in_a_corner_may_have_been_turned_over_alone) {
  // One part has no area in the plane of the whole, where it looks like a spike.
  const PolygonMesh pinched =
      shapes::from_lists({{5, 0, -4}, {0, 0, -4}, {7.5, 12.5, -7.5}, {10, 0, -6}, {10, 0, 0}}, {{0, 1, 2, 3, 1, 4}});
  EXPECT_FALSE(is_refuted(verdict_on(pinched, cut_into(pinched, {{1, 2, 3}, {0, 1, 4}}))));
  EXPECT_FALSE(is_refuted(verdict_on(pinched, cut_into(pinched, {{1, 2, 3}, {0, 4, 1}}))));
  // The same holds if the outline comes back to a place that is nearly the same.
  const PolygonMesh nearly = shapes::from_lists(
      {{5, 0, -4}, {0, 0, -4}, {7.5, 12.5, -7.5}, {10, 0, -6}, {10, 0, 0}, {0, 1e-9, -4}}, {{0, 1, 2, 3, 5, 4}});
  EXPECT_FALSE(is_refuted(verdict_on(nearly, cut_into(pinched, {{1, 2, 3}, {0, 4, 1}}), 1e-8)));
}

TEST(check_polygons, a_hole_that_runs_the_same_way_as_the_outline_around_it_is_not_judged) {
  const PolygonMesh ring =
      shapes::from_lists({{0, 0, 0}, {9, 0, 0}, {9, 9, 0}, {0, 9, 0}, {3, 3, 0}, {6, 3, 0}, {6, 6, 0}, {3, 6, 0}},
                         {{0, 1, 2, 3, 0, 4, 5, 6, 7, 4}});
  const PolygonMesh triangles =
      cut_into(ring, {{0, 1, 5}, {0, 5, 4}, {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}});
  EXPECT_FALSE(is_refuted(verdict_on(ring, triangles)));
}

TEST(check_polygons, a_bent_polygon_may_be_cut_either_way) {
  const PolygonMesh bent = shapes::from_lists({{0, 0, 0}, {1, 0, 0.5}, {1, 1, 0}, {0, 1, 0.5}}, {{0, 1, 2, 3}});
  EXPECT_FALSE(is_refuted(verdict_on(bent, cut_into(bent, {{0, 1, 2}, {0, 2, 3}}))));
  EXPECT_FALSE(is_refuted(verdict_on(bent, cut_into(bent, {{0, 1, 3}, {1, 2, 3}}))));
}

TEST(check_polygons, welding_may_have_moved_corners_by_its_tolerance) {
  const PolygonMesh square = shapes::polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  PolygonMesh moved = cut_into(square, {{0, 1, 2}, {0, 2, 3}});
  moved.positions[VertexId(2)] = {1.001, 1.001, 0};
  EXPECT_TRUE(is_refuted(verdict_on(square, moved)));
  EXPECT_FALSE(is_refuted(verdict_on(square, moved, 0.002)));
}

/// The input polygons of which check_polygons says with this budget that their triangles are wrong. There are squares,
/// one beside the other, and for each of them one triangle, which is a half of it.
std::vector<std::uint32_t> wrong_squares(int count, std::uint64_t max_pairs) {
  std::vector<Vec3> points;
  std::vector<std::vector<std::uint32_t>> squares, halves;
  for (int i = 0; i < count; ++i) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const Vec2 p : {Vec2{0, 0}, {1, 0}, {1, 1}, {0, 1}}) points.push_back({p.x + 2 * i, p.y, 0});
    squares.push_back({first, first + 1, first + 2, first + 3});
    halves.push_back({first, first + 1, first + 2});
  }
  const PolygonMesh input = shapes::from_lists(points, squares), triangles = shapes::from_lists(points, halves);
  const Example e = example(triangles, triangles);
  const Claim claim{e.surface,         e.surface_patch, e.frames, e.positions, e.faces, e.face_patch, e.corner_uv,
                    e.plane_tolerance, false,           nullptr,  nullptr,     {},      &input};
  RunControl control;
  verification::FoundFaults faults(e.frames.size(), false);
  const verification::NumberedClaim numbered = verification::number_claim(claim, faults, control);
  verification::check_polygons(claim, numbered, faults, control, max_pairs);
  Verdict verdict;
  faults.write_to(verdict);
  std::vector<std::uint32_t> wrong;
  for (const PatchId p : verdict.failed_patches) wrong.push_back(p.value);
  std::sort(wrong.begin(), wrong.end());
  return wrong;
}

TEST(check_polygons, polygons_share_a_budget_of_pairs_of_edges_in_the_order_of_the_file) {
  // A square has six pairs of edges. Along an axis, one of them is apart.
  constexpr std::uint64_t kPairs = 5;
  const std::vector<std::uint32_t> all{0, 1, 2, 3};
  EXPECT_EQ(wrong_squares(4, 4 * kPairs), all);
  EXPECT_EQ(wrong_squares(4, verification::kMaxEdgePairs), all);
  EXPECT_EQ(wrong_squares(4, 4 * kPairs - 1), (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(wrong_squares(4, kPairs), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(wrong_squares(4, kPairs - 1), (std::vector<std::uint32_t>{}));
}

TEST(check_polygons, many_polygons_are_all_looked_at_with_any_number_of_threads) {
  // There are more of them than in one block.
  for (const int threads : {1, 2, 7})
    tbb::task_arena(threads).execute(
        [&] { EXPECT_EQ(wrong_squares(1500, verification::kMaxEdgePairs).size(), 1500u) << threads; });
}

}  // namespace
}  // namespace remesh
