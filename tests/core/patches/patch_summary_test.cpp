#include "core/patches/planar/patch_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/mesh/face_marks.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

PatchSummaries summarised(const StageChain& chain, const FaceRungs& rungs = {}) {
  const std::vector<double> areas = patch_areas(chain.patches, chain.geometry, chain.control);
  return summarise_patches(chain.surface, chain.adjacency, areas, chain.patches, chain.loops, chain.essential,
                           SurfaceRungs(chain.surface, chain.adjacency, {}, rungs, false), chain.control);
}

TEST(patch_summary, the_ring_of_section_1_1) {
  const PatchSummaries s = summarised(StageChain(shapes::ring(4)));
  ASSERT_EQ(s.patches.size(), 1u);
  EXPECT_EQ(s.patches[0].normal, (Vec3{0, 0, 1}));
  EXPECT_DOUBLE_EQ(s.patches[0].offset, 1);
  EXPECT_DOUBLE_EQ(s.patches[0].area, 28);
  EXPECT_EQ(s.patches[0].input_faces, 128u);
  EXPECT_EQ(s.patches[0].output_faces, 8u);
  EXPECT_EQ(s.patches[0].loops, 2u);
  EXPECT_EQ(s.patches[0].essential_vertices, 8u);
  EXPECT_EQ(s.patches[0].status, PatchStatus::kRemeshed);
  EXPECT_EQ(s.patches[0].deviation, 0);
  EXPECT_EQ(s.triangles, 8u);
  EXPECT_EQ(s.volume_bound, 0);
}

TEST(patch_summary, the_prediction_is_what_the_triangulation_has) {
  for (const PolygonMesh& mesh :
       {shapes::ring(2), shapes::box({1, 2, 3}, 3), shapes::cylinder(13, 1, 2), shapes::slotted_plate(2),
        shapes::flat({"#####", "#...#", "#.#.#", "#...#", "#####"}), shapes::flat({"####", "#.##", "##.#", "####"}),
        shapes::flat({"###", "#.#", "##."}), shapes::two_squares_touching_at_a_vertex(2),
        // A slit, and a tip that touches a patch inside.
        shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {0, 2, 0}, {1, 1, 0}, {2, 1, 0}, {1, 1, 1}, {2, 1, 1}},
                           {{0, 1, 5, 4}, {1, 2, 5}, {2, 3, 4, 5}, {3, 0, 4}, {4, 5, 7, 6}}),
        shapes::joined(shapes::sheet(2, 2, 2, 2),
                       shapes::from_lists({{1, 1, 0}, {0.5, 0.5, 1}, {1.5, 0.5, 1}, {1, 1.5, 1}},
                                          {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}}))}) {
    const StageChain chain(mesh);
    const PatchSummaries s = summarised(chain);
    std::uint64_t sum = 0;
    for (std::size_t p = 0; p < s.patches.size(); ++p) {
      EXPECT_EQ(s.patches[p].output_faces, chain.meshes[PatchId(p)].mesh.triangle_count());
      EXPECT_EQ(s.patches[p].essential_vertices, chain.meshes[PatchId(p)].vertices.size());
      sum += s.patches[p].output_faces;
    }
    EXPECT_EQ(s.triangles, sum);
  }
}

TEST(patch_summary, measures_are_in_model_units) {
  const PatchSummaries s = summarised(StageChain(shapes::moved(shapes::scaled(shapes::ring(2), 100), {7, 8, 9})));
  EXPECT_NEAR(s.patches[0].area, 280000, 1e-6);
  EXPECT_NEAR(s.patches[0].offset, 109, 1e-9);
}

TEST(patch_summary, measures_beyond_the_largest_double_are_that) {
  const double far = std::ldexp(1.0, 700);
  const PatchSummaries s = summarised(StageChain(
      shapes::from_lists({{0, 0, 0.125 * far}, {far, 0, 0}, {far, far, 0}, {0, far, 0}}, {{0, 1, 2, 3}}), 0.5 * far));
  ASSERT_EQ(s.patches.size(), 1u);
  EXPECT_EQ(s.patches[0].area, std::numeric_limits<double>::max());
  EXPECT_GT(s.patches[0].deviation, 0);
  EXPECT_EQ(s.volume_bound, std::numeric_limits<double>::max());
}

TEST(patch_summary, the_deviation_is_the_largest_distance_from_the_plane_and_bounds_the_volume) {
  // A quadrilateral whose corners lie 1/8 above and below its plane, by turns.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0.125}, {1, 0, -0.125}, {1, 1, 0.125}, {0, 1, -0.125}}, {{0, 1, 2, 3}});
  const PatchSummaries s = summarised(StageChain(mesh, 0.5));
  ASSERT_EQ(s.patches.size(), 1u);
  EXPECT_NEAR(s.patches[0].deviation, 0.125, 1e-12);
  EXPECT_NEAR(s.volume_bound, 2 * s.patches[0].area * 0.125, 1e-12);
}

TEST(patch_summary, a_patch_that_climbed_the_ladder_is_reduced_and_says_why) {
  StageChain chain(shapes::box({1, 1, 1}, 2));
  const FailedFaces failed{covered_by(chain.surface, chain.patches.faces_of(PatchId(3))),
                           PatchReason::kOverlappingFaces};
  const PatchSummaries s = summarised(chain, one_rung_up({}, std::vector{failed}, chain.surface.face_count()));
  EXPECT_EQ(s.patches[3].status, PatchStatus::kReduced);
  EXPECT_EQ(s.patches[3].reason, PatchReason::kOverlappingFaces);
  EXPECT_EQ(s.patches[2].status, PatchStatus::kRemeshed);
  EXPECT_EQ(s.patches[2].reason, PatchReason::kNone);
}

}  // namespace
}  // namespace remesh
