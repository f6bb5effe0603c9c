#include "core/patches/meshing/patch_meshing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/planes/projection.h"
#include "tests/support/invariance.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"
#include "tests/support/triangulation_checks.h"

namespace remesh {
namespace {

/// Expects that every patch is meshed. Its points are in order and where the chart says. Its triangles are valid and
/// Delaunay, and have the area of the patch.
void expect_meshed(const StageChain& chain) {
  ASSERT_EQ(chain.meshes.size(), chain.patches.count());
  for (std::uint32_t p = 0; p < chain.meshes.size(); ++p) {
    const PatchMesh& patch = chain.meshes[PatchId(p)];
    const PatchChart chart = chain.charts()[PatchId(p)];
    SCOPED_TRACE(p);
    ASSERT_EQ(patch.reason, PatchReason::kNone);
    EXPECT_EQ(patch.loops, chain.loop_count(PatchId(p)));
    ASSERT_EQ(patch.uv.size(), patch.vertices.size());
    for (std::size_t i = 0; i < patch.uv.size(); ++i) {
      EXPECT_EQ(patch.uv[i], chart.to_plane(chain.surface.positions[patch.vertices[i]]));
      if (i > 0) {
        EXPECT_LT(patch.uv[i - 1], patch.uv[i]);
      }
      EXPECT_TRUE(chain.essential[patch.vertices[i]]);
    }
    expect_valid(patch.uv, patch.mesh);
    expect_locally_delaunay(patch.uv, patch.mesh);
    double area = 0;
    for (const FaceId f : chain.patches.faces_of(PatchId(p))) area += chain.geometry[f].area;
    area *= chain.surface.unit * chain.surface.unit;
    const double meshed = area_of(patch.uv, patch.mesh) * chart.scale({}) * chart.scale({});
    EXPECT_NEAR(meshed / area, 1, 1e-9);
  }
}

TEST(patch_meshing, shapes_of_flat_faces_are_meshed) {
  for (const PolygonMesh& mesh :
       {shapes::ring(4), shapes::box({1, 2, 3}, 4), shapes::cylinder(17, 1, 3), shapes::l_bracket(3),
        shapes::plate_with_round_hole(24), shapes::slotted_plate(2), shapes::three_pages(2), shapes::double_sheet(3),
        shapes::flat({"#####", "#...#", "#.#.#", "#...#", "#####"}), shapes::flat({"####", "#.##", "##.#", "####"}),
        shapes::flat({"###", "#.#", "##."})}) {
    const StageChain chain(mesh);
    expect_meshed(chain);
  }
}

TEST(patch_meshing, a_slit_stays_an_edge) {
  const StageChain chain(
      shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {1, 1, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}},
                         {{0, 1, 5, 4}, {1, 2, 5}, {2, 3, 4, 5}, {3, 0, 4}, {4, 5, 7, 6}}));
  expect_meshed(chain);
  const PatchMesh& sheet = chain.meshes[chain.patch_of(0)];
  EXPECT_EQ(sheet.mesh.triangle_count(), 6u);
  EXPECT_EQ(constrained_edges_of(sheet.mesh).size(), 5u);
}

TEST(patch_meshing, what_touches_inside_is_a_point_of_the_patch) {
  const StageChain chain(shapes::joined(
      shapes::sheet(2, 2, 2, 2),
      shapes::from_lists({{1, 1, 0}, {0.5, 0.5, 1}, {1.5, 0.5, 1}, {1, 1.5, 1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}})));
  expect_meshed(chain);
  EXPECT_EQ(chain.meshes[PatchId(0)].mesh.triangle_count(), 4u);
}

TEST(patch_meshing, a_patch_of_one_triangle_cannot_fail) {
  // Needles whose height is far below the grid of the projection.
  for (const double height : {1e-3, 1e-12, 1e-20, 1e-60, 1e-200})
    for (const Vec3& shift : {Vec3{0, 0, 0}, Vec3{1, 1, 1}}) {
      const PolygonMesh mesh =
          shapes::from_lists({Vec3{0, 0, 0}, Vec3{1, 0, 0.25}, Vec3{0.5, height, 0.125}, shift + Vec3{-1, -1, -1},
                              shift + Vec3{-2, -1, -1}, shift + Vec3{-1, -2, -1}},
                             {{0, 1, 2}, {3, 4, 5}});
      const StageChain chain(mesh);
      for (const PatchMesh& patch : chain.meshes) {
        EXPECT_EQ(patch.reason, PatchReason::kNone) << height;
        EXPECT_EQ(patch.mesh.triangle_count(), 1u) << height;
        expect_valid(patch.uv, patch.mesh);
      }
    }
}

TEST(patch_meshing, coordinates_are_on_the_coarse_grid_unless_points_would_meet) {
  const StageChain coarse(shapes::rotated(shapes::sheet(3, 2, 1, 1), {1, 2, 3}, 40));
  EXPECT_EQ(coarse.charts()[PatchId(0)].grid(), kPatchGrid);
  // Two corners 2^-44 apart: one point on the coarse grid.
  const StageChain close(
      shapes::polygon({{0, 0}, {1, 0}, {1, 1}, {0.5, 1}, {0.5, 0.5}, {0.5 - 0x1p-44, 0.5}, {0.25, 1}, {0, 1}}), 1e-15);
  EXPECT_EQ(close.charts()[PatchId(0)].grid(), kFineGrid);
  expect_meshed(close);
}

TEST(patch_meshing, a_loop_that_crosses_itself_is_told) {
  // A spiral staircase in one plane by label and tolerance: the strip turns by 450 degrees and runs over itself.
  std::vector<Vec3> positions;
  std::vector<std::vector<std::uint32_t>> faces;
  for (int i = 0; i <= 40; ++i) {
    const double angle = 450.0 / 40 * i * 3.14159265358979 / 180;
    for (const double radius : {1.0, 2.0}) positions.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
    const auto k = static_cast<std::uint32_t>(2 * i);
    if (i < 40) faces.push_back({k, k + 1, k + 3, k + 2});
  }
  const StageChain chain(shapes::from_lists(positions, faces));
  ASSERT_EQ(chain.meshes.size(), 1u);
  EXPECT_EQ(chain.meshes[PatchId(0)].reason, PatchReason::kSelfIntersectingLoop);
}

STAGE(patch_meshing, test::kWorkers) {
  const StageChain chain(shapes::rotated(shapes::sphere(4), {1, 2, 3}, 10));
  for (const PatchMesh& patch : chain.meshes) trial.in_order(patch.vertices, patch.uv, triangles_of(patch.mesh));
}

}  // namespace
}  // namespace remesh
