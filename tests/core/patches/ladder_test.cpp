#include "core/patches/planar/ladder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// A box whose patches stand at the foot of the ladder.
struct Climb {
  explicit Climb(const PolygonMesh& mesh) : chain(mesh), ladder(chain.surface) {}

  std::vector<FaceId> step(const std::vector<FailedPatch>& failed) {
    return ladder.step(chain.patches, chain.loops, chain.adjacency, failed, chain.regions);
  }
  int face_rung(std::uint32_t f) const { return ladder.rung()[FaceId(f)]; }

  StageChain chain;
  Ladder ladder;
};

TEST(ladder, it_begins_with_the_labels_and_nothing_forced) {
  const Climb climb(with_groups(shapes::sheet(2, 1, 2, 1), {0, 0, 1, 1}));
  EXPECT_EQ(climb.ladder.zone(), climb.chain.surface.face_label);
  EXPECT_EQ(climb.face_rung(0), 0);
  Ladder ladder(climb.chain.surface);
  EXPECT_EQ(std::count(ladder.forced().begin(), ladder.forced().end(), 0), 6);
}

TEST(ladder, a_patch_that_failed_loses_its_region_and_rises_and_its_boundary_is_forced) {
  Climb climb(shapes::box({1, 1, 1}, 3));
  const PatchId failed(2);
  const auto region_of = climb.chain.regions.of_face;
  climb.step({{failed, PatchReason::kSelfIntersectingLoop}});
  std::set<VertexId> boundary;
  for (const std::uint32_t h : climb.chain.loops.loop(climb.chain.loops.patch_begin[2]))
    boundary.insert(climb.chain.adjacency.from(h));
  EXPECT_EQ(boundary.size(), 12u);
  for (std::uint32_t v = 0; v < climb.chain.surface.vertex_count(); ++v)
    EXPECT_EQ(climb.ladder.forced()[VertexId(v)], boundary.count(VertexId(v))) << v;
  std::set<std::uint32_t> zones, other_zones;
  for (std::uint32_t i = 0; i < climb.chain.surface.face_count(); ++i) {
    const FaceId f(i);
    const bool is_failed = climb.chain.patches.of_face[f] == failed;
    EXPECT_EQ(climb.face_rung(i), is_failed ? 1 : 0);
    EXPECT_EQ(climb.chain.regions.of_face[f].is_valid(), !is_failed);
    EXPECT_EQ(climb.ladder.reason(f), is_failed ? PatchReason::kSelfIntersectingLoop : PatchReason::kNone);
    if (!is_failed) {
      EXPECT_EQ(climb.chain.regions.of_face[f], region_of[f]);
    }
    (is_failed ? zones : other_zones).insert(climb.ladder.zone()[f]);
  }
  EXPECT_EQ(zones.size(), 1u);
  EXPECT_FALSE(other_zones.count(*zones.begin())) << "its faces join each other only";
}

TEST(ladder, two_patches_that_failed_are_kept_apart) {
  Climb climb(shapes::box({1, 1, 1}, 1));
  climb.step({{PatchId(0), PatchReason::kNotPlanar}, {PatchId(1), PatchReason::kNotPlanar}});
  EXPECT_NE(climb.ladder.zone()[climb.chain.patches.faces_of(PatchId(0))[0]],
            climb.ladder.zone()[climb.chain.patches.faces_of(PatchId(1))[0]]);
}

TEST(ladder, the_first_reason_stays) {
  Climb climb(shapes::sheet(1, 1, 1, 1));
  climb.step({{PatchId(0), PatchReason::kOverlappingFaces}});
  climb.step({{PatchId(0), PatchReason::kVerificationFailed}});
  EXPECT_EQ(climb.ladder.reason(FaceId(0)), PatchReason::kOverlappingFaces);
  EXPECT_EQ(climb.face_rung(0), 2);
}

TEST(ladder, a_face_that_fails_on_the_last_step_is_handed_back) {
  Climb climb(shapes::sheet(1, 1, 1, 1));
  for (int rung = 1; rung <= kSingleFace; ++rung) {
    EXPECT_TRUE(climb.step({{PatchId(0), PatchReason::kVerificationFailed}}).empty());
    EXPECT_EQ(climb.face_rung(0), rung);
  }
  EXPECT_EQ(climb.step({{PatchId(0), PatchReason::kVerificationFailed}}), (std::vector{FaceId(0), FaceId(1)}));
}

TEST(ladder, a_patch_of_one_face_goes_to_the_last_step_at_once) {
  Climb climb(shapes::sphere(1));
  ASSERT_EQ(climb.chain.patches.faces_of(PatchId(0)).size(), 1u);
  const FaceId face = climb.chain.patches.faces_of(PatchId(0))[0];
  EXPECT_TRUE(climb.step({{PatchId(0), PatchReason::kVerificationFailed}}).empty());
  EXPECT_EQ(climb.face_rung(face.value), kSingleFace);
  EXPECT_EQ(climb.step({{PatchId(0), PatchReason::kVerificationFailed}}), std::vector{face});
}

TEST(ladder, after_many_rounds_a_patch_goes_to_single_faces_at_once) {
  // A chain of patches that fail one after the other must not cost a round for each of their steps.
  Climb climb(shapes::box({1, 1, 1}, 1));
  int rounds = 0;
  for (std::uint32_t p = 0; p < 6; ++p)
    while (climb.face_rung(climb.chain.patches.faces_of(PatchId(p))[0].value) < kSingleFace) {
      climb.step({{PatchId(p), PatchReason::kNotPlanar}});
      ++rounds;
    }
  EXPECT_LT(rounds, 6 * kSingleFace);
}

}  // namespace
}  // namespace remesh
