#include "core/patches/planar/face_rungs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/mesh/face_marks.h"
#include "core/patches/planar/coplanar_regions.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// A surface whose patches climb the ladder.
struct Climb {
  explicit Climb(const PolygonMesh& mesh) : chain(mesh) {}

  FailedFaces patch(std::uint32_t p, PatchReason reason = PatchReason::kVerificationFailed) const {
    const auto faces = chain.patches.faces_of(PatchId(p));
    return {covered_by(chain.surface, faces), reason, faces.size() == 1, false};
  }
  void step(const std::vector<FailedFaces>& failed) { rungs = one_rung_up(rungs, failed, chain.surface.face_count()); }
  SurfaceRungs on_surface() const { return SurfaceRungs(chain.surface, chain.adjacency, {}, rungs, false); }
  int face_rung(std::uint32_t f) const { return rungs.rung[f]; }

  StageChain chain;
  FaceRungs rungs;
};

TEST(face_rungs, it_begins_with_the_labels_and_nothing_forced) {
  const Climb climb(with_groups(shapes::sheet(2, 1, 2, 1), {0, 0, 1, 1}));
  const SurfaceRungs rungs = climb.on_surface();
  EXPECT_EQ(rungs.zone, climb.chain.surface.face_label);
  EXPECT_EQ(rungs.rung[FaceId(0)], 0);
  EXPECT_EQ(std::count(rungs.is_forced.begin(), rungs.is_forced.end(), 0), 6);
}

TEST(face_rungs, a_patch_that_failed_rises_and_its_boundary_is_forced) {
  Climb climb(shapes::box({1, 1, 1}, 3));
  const PatchId failed(2);
  climb.step({climb.patch(2, PatchReason::kSelfIntersectingLoop)});
  const SurfaceRungs rungs = climb.on_surface();
  std::set<VertexId> boundary;
  for (const std::uint32_t h : climb.chain.loops.loop(climb.chain.loops.patch_begin[2]))
    boundary.insert(climb.chain.adjacency.from(h));
  EXPECT_EQ(boundary.size(), 12u);
  for (std::uint32_t v = 0; v < climb.chain.surface.vertex_count(); ++v)
    EXPECT_EQ(rungs.is_forced[VertexId(v)], boundary.count(VertexId(v))) << v;
  std::set<std::uint32_t> zones, other_zones;
  for (FaceId f(0); f.value < climb.chain.surface.face_count(); ++f.value) {
    const bool is_failed = climb.chain.patches.of_face[f] == failed;
    EXPECT_EQ(rungs.rung[f], is_failed ? 1 : 0);
    EXPECT_EQ(rungs.reason_of(f), is_failed ? PatchReason::kSelfIntersectingLoop : PatchReason::kNone);
    (is_failed ? zones : other_zones).insert(rungs.zone[f]);
  }
  EXPECT_EQ(zones.size(), 1u);
  EXPECT_FALSE(other_zones.count(*zones.begin())) << "its faces join each other only";
}

TEST(face_rungs, zones_of_failures_differ_from_labels) {
  Climb climb(with_groups(shapes::sheet(2, 1, 2, 1), {0, 0, 1, 1}));
  climb.step({climb.patch(0)});
  const SurfaceRungs rungs = climb.on_surface();
  EXPECT_EQ(rungs.zone[FaceId(2)], climb.chain.surface.face_label[FaceId(2)]);
  EXPECT_EQ(std::set<std::uint32_t>(rungs.zone.begin(), rungs.zone.end()).size(), 2u);
}

TEST(face_rungs, two_patches_that_failed_are_kept_apart) {
  Climb climb(shapes::box({1, 1, 1}, 1));
  climb.step({climb.patch(0), climb.patch(1)});
  EXPECT_NE(climb.rungs.zone[climb.patch(0).faces[0].value], climb.rungs.zone[climb.patch(1).faces[0].value]);
}

TEST(face_rungs, the_first_reason_stays) {
  Climb climb(shapes::sheet(1, 1, 1, 1));
  climb.step({climb.patch(0, PatchReason::kOverlappingFaces)});
  climb.step({climb.patch(0, PatchReason::kVerificationFailed)});
  EXPECT_EQ(climb.rungs.reason[0], PatchReason::kOverlappingFaces);
  EXPECT_EQ(climb.face_rung(0), 2);
}

TEST(face_rungs, faces_that_fail_on_the_last_rung_are_exhausted) {
  Climb climb(shapes::sheet(1, 1, 1, 1));
  for (int rung = 1; rung <= kSingleFace; ++rung) {
    EXPECT_FALSE(exhausted_faces(climb.rungs, std::vector{climb.patch(0)}));
    climb.step({climb.patch(0)});
    EXPECT_EQ(climb.face_rung(0), rung);
  }
  EXPECT_EQ(exhausted_faces(climb.rungs, std::vector{climb.patch(0)}), (std::vector{FaceId(0), FaceId(1)}));
}

TEST(face_rungs, a_patch_of_one_face_goes_to_the_last_rung_at_once) {
  Climb climb(shapes::sphere(1));
  ASSERT_TRUE(climb.patch(0).is_single);
  climb.step({climb.patch(0)});
  EXPECT_EQ(climb.face_rung(climb.patch(0).faces[0].value), kSingleFace);
  EXPECT_EQ(exhausted_faces(climb.rungs, std::vector{climb.patch(0)}), climb.patch(0).faces);
}

TEST(face_rungs, a_face_without_area_is_exhausted_from_the_beginning) {
  Climb climb(shapes::sphere(1));
  FailedFaces kept = climb.patch(0);
  kept.is_kept = true;
  EXPECT_EQ(exhausted_faces(climb.rungs, std::vector{kept}), kept.faces);
  EXPECT_FALSE(exhausted_faces(climb.rungs, std::vector{kept, climb.patch(1)})) << "the other one can still rise";
}

TEST(face_rungs, after_many_steps_a_patch_goes_to_single_faces_at_once) {
  // A chain of patches that fail one after the other must not cost a step for each of their rungs.
  Climb climb(shapes::box({1, 1, 1}, 1));
  int steps = 0;
  for (std::uint32_t p = 0; p < 6; ++p)
    for (bool is_first = true; is_first || climb.face_rung(climb.patch(p).faces[0].value) < kSingleFace;
         is_first = false) {
      climb.step({climb.patch(p)});
      ++steps;
    }
  EXPECT_LT(steps, 6 * kSingleFace);
}

}  // namespace
}  // namespace remesh
