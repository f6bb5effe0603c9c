// Two stages that stand for those that put another surface in the place of the prepared one: one cuts each face in two,
// and one makes one face of each two. Marks, reasons and distances come back as input faces, whatever was replaced.

#include "core/output/run/replaced.h"

#include <gtest/gtest.h>

#include "core/mesh/face_marks.h"
#include "core/output/result/face_labels.h"
#include "core/patches/planar/face_rungs.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

/// Cuts each triangle in two, at the middle of its longest edge. The halves cover the face.
Replaced cut_each_face(const Surface& before) {
  Replaced replaced;
  replaced.surface = before;
  FaceList faces;
  CoveredFaces covers;
  covers.begin.push_back(0);
  std::vector<Vec3> middles;
  for (FaceId f(0); f.value < before.face_count(); ++f.value) {
    const auto t = before.face(f);
    const VertexId middle(before.vertex_count() + middles.size());
    middles.push_back(0.5 * (before.positions[t[0]] + before.positions[t[1]]));
    for (const Triangle& half : {Triangle{t[0], middle, t[2]}, Triangle{middle, t[1], t[2]}}) {
      faces.add_face(half, before.face_source[f], before.label(f));
      const auto covered = before.covered(f);
      covers.faces.insert(covers.faces.end(), covered.begin(), covered.end());
      covers.begin.push_back(covers.faces.size());
    }
  }
  replaced.surface.positions.change(
      [&](std::vector<Vec3>& all) { all.insert(all.end(), middles.begin(), middles.end()); });
  for (const Vec3& p : middles) {
    replaced.surface.local.push_back(replaced.surface.to_local(p));
    replaced.surface.vertex_source.push_back(VertexId(0));
  }
  replaced.surface.take_faces(std::move(faces));
  replaced.surface.covers = std::move(covers);
  replaced.distance = 0.25;
  return replaced;
}

/// Makes one quadrangle of the triangles 2 i and 2 i + 1, which share the edge from corner 2 of the first.
Replaced merge_pairs(const Surface& before) {
  Replaced replaced;
  replaced.surface = before;
  FaceList faces;
  CoveredFaces covers;
  covers.begin.push_back(0);
  for (FaceId f(0); f.value < before.face_count(); f.value += 2) {
    const auto a = before.face(f), b = before.face(FaceId(f.value + 1));
    std::vector<VertexId> loop(a.begin(), a.end());
    for (std::size_t k = 0; k < 3; ++k)
      if (std::find(a.begin(), a.end(), b[k]) == a.end()) {
        const VertexId before_it = b[(k + 2) % 3];
        loop.insert(std::find(loop.begin(), loop.end(), before_it) + 1, b[k]);
      }
    faces.add_face(loop, before.face_source[f], before.label(f));
    for (const FaceId g : {f, FaceId(f.value + 1)}) {
      const auto covered = before.covered(g);
      covers.faces.insert(covers.faces.end(), covered.begin(), covered.end());
    }
    covers.begin.push_back(covers.faces.size());
  }
  replaced.surface.take_faces(std::move(faces));
  replaced.surface.covers = std::move(covers);
  replaced.distance = 0.5;
  replaced.volume = 2;
  return replaced;
}

/// A box of twelve triangles, of which 2 i and 2 i + 1 are one side, after some stages.
struct Stages {
  explicit Stages(const std::vector<Replaced (*)(const Surface&)>& stages) : chain(shapes::box({1, 1, 1}, 1)) {
    surface = chain.surface;
    for (const auto stage : stages) {
      Replaced replaced = stage(surface);
      spent.add(replaced);
      surface = std::move(replaced.surface);
    }
  }

  StageChain chain;
  Surface surface;
  SpentOnStages spent;
};

const std::vector<std::vector<Replaced (*)(const Surface&)>> kOrders{
    {}, {cut_each_face}, {merge_pairs}, {cut_each_face, cut_each_face}, {cut_each_face, merge_pairs}};

TEST(replaced, a_mark_of_a_face_is_a_mark_of_the_input_faces_that_it_covers) {
  for (const auto& stages : kOrders) {
    const Stages made(stages);
    for (FaceId f(0); f.value < made.surface.face_count(); ++f.value) {
      FaceMarks marks;
      mark(marks, covered_by(made.surface, std::vector{f}), 12);
      EXPECT_TRUE(are_marked(marks, made.surface.covered(f)));
      for (const FaceId source : made.surface.covered(f)) EXPECT_EQ(marks[source.value], 1);
      // A face is marked if, and only if, all input faces that it covers are.
      for (FaceId g(0); g.value < made.surface.face_count(); ++g.value) {
        bool are_all = true;
        for (const FaceId source : made.surface.covered(g)) are_all = are_all && marks[source.value] != 0;
        EXPECT_EQ(are_marked(marks, made.surface.covered(g)), are_all);
      }
    }
  }
}

TEST(replaced, each_input_face_is_covered) {
  for (const auto& stages : kOrders) {
    const Stages made(stages);
    std::vector<FaceId> all;
    for (FaceId f(0); f.value < made.surface.face_count(); ++f.value) all.push_back(f);
    EXPECT_EQ(covered_by(made.surface, all).size(), 12u);
  }
}

TEST(replaced, a_reason_goes_through_input_faces_to_all_faces_that_cover_them) {
  for (const auto& stages : kOrders) {
    const Stages made(stages);
    RunControl control;
    const Adjacency adjacency(made.surface.vertex_count(), made.surface.face_begin, made.surface.corners, control);
    const FailedFaces failed{{FaceId(0), FaceId(1)}, PatchReason::kOverlappingFaces};
    const SurfaceRungs rungs(made.surface, adjacency, {}, one_rung_up({}, std::vector{failed}, 12), false);
    for (FaceId f(0); f.value < made.surface.face_count(); ++f.value) {
      const bool is_of_side = made.surface.covered(f).front().value < 2;
      EXPECT_EQ(rungs.reason_of(f), is_of_side ? PatchReason::kOverlappingFaces : PatchReason::kNone);
      EXPECT_EQ(rungs.rung[f], is_of_side ? 1 : 0);
    }
  }
}

TEST(replaced, distances_and_volumes_add_up) {
  const Stages made({cut_each_face, merge_pairs});
  EXPECT_EQ(made.spent.stages, 2);
  EXPECT_EQ(made.spent.distance, 0.75);
  EXPECT_EQ(made.spent.volume, 2);
}

TEST(replaced, new_faces_of_a_patch_cover_all_that_the_patch_covered) {
  // Two faces lie in each side of the box. A stage makes two new ones of them.
  const StageChain sides(shapes::box({1, 1, 1}, 1));
  ASSERT_EQ(sides.patches.count(), 6u);
  IdVector<FaceId, PatchId> patch;
  FilledIdVector<FaceId, FaceId> source;
  for (FaceId f(0); f.value < 12; ++f.value) {
    patch.push_back(sides.patches.of_face[f]);
    source.push_back(f);
  }
  const CoveredFaces covers = covers_of_new_faces(sides.surface, sides.patches, patch, source);
  for (FaceId f(0); f.value < 12; ++f.value) {
    const bool is_first = sides.patches.faces_of(patch[f]).front() == f;
    EXPECT_EQ(covers.of(f).size(), is_first ? 2u : 1u);
  }
}

TEST(replaced, the_patch_of_an_input_face_is_that_of_the_face_that_covers_it) {
  const Stages made({merge_pairs});
  StageChain sides(shapes::box({1, 1, 1}, 1));
  PatchSet patches = sides.patches;
  patches.of_face.clear();
  for (std::uint32_t f = 0; f < 6; ++f) patches.of_face.push_back(PatchId(f));
  const IdVector<FaceId, PatchId> of_input = patches_of_input(made.surface, patches, 12);
  for (std::uint32_t f = 0; f < 12; ++f) EXPECT_EQ(of_input[FaceId(f)], PatchId(f / 2));
}

}  // namespace
}  // namespace remesh
