// Tests by a table what is tried next after each outcome. No mesh is needed for that.

#include "core/output/run/learn.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "core/output/run/trace.h"
#include "core/patches/planar/coplanar_regions.h"

namespace remesh {
namespace {

using End = Outcome::End;

constexpr std::size_t kFaces = 10;

Goals goals_in_proportion() {
  Goals goals{};
  goals.max_faces = 1'000'000;
  goals.faces_without_min_edge = 1000;
  goals.lowest_min_edge = 0x1p-10;
  return goals;
}

Decisions first() { return Decisions(MinEdgeSearch(goals_in_proportion())); }

Outcome outcome_of(End end) {
  Outcome outcome;
  outcome.end = end;
  outcome.input_faces = kFaces;
  outcome.facts.are_goals_set = outcome.facts.is_any_refined = outcome.facts.is_min_edge_automatic = true;
  outcome.facts.max_faces = goals_in_proportion().max_faces;
  outcome.facts.faces_without_min_edge = goals_in_proportion().faces_without_min_edge;
  return outcome;
}

/// A patch of two input faces that has failed.
Outcome with_failure(Outcome outcome, std::uint32_t face, bool was_frozen = false) {
  outcome.failed.push_back({{FaceId(face), FaceId(face + 1)}, PatchReason::kVerificationFailed});
  outcome.was_frozen.push_back(was_frozen ? 1 : 0);
  return outcome;
}

Outcome with_fault(Outcome outcome, std::uint32_t face) {
  outcome.faults.push_back({{FaceId(face)}, SurfaceId(0), {}});
  return outcome;
}

/// A row of the table: what was decided, what came of it, and what is decided then, in the words of the trace.
struct Row {
  std::string name;
  Decisions now;
  Outcome outcome;
  std::string decided;
};

std::vector<Row> rows() {
  Decisions nothing_yet = first(), rest = first(), on_last_rung = first(), tightened = first();
  nothing_yet.refinement.part = RefinedPart::kNothingYet;
  nothing_yet.refinement.failed.assign(kFaces, 0);
  nothing_yet.refinement.failed[4] = 1;
  rest.refinement.part = RefinedPart::kRest;
  for (int rung = 0; rung < kSingleFace; ++rung)
    on_last_rung.rungs = one_rung_up(on_last_rung.rungs, with_failure(outcome_of(End::kCheckFailed), 2).failed, kFaces);
  tightened.curved.rung.assign(kFaces, CurvedRung::kJoined);
  tightened.curved.rung[3] = CurvedRung::kTightened;

  Outcome too_many = outcome_of(End::kTooManyFaces);
  too_many.faces = 1001;
  Outcome far_too_many = outcome_of(End::kTooManyFaces);
  far_too_many.facts.is_min_edge_automatic = false;
  far_too_many.faces = 1'000'001;
  Outcome gaps = outcome_of(End::kGapsTooFine);
  gaps.coarsest = 0.5;
  Outcome coarser = outcome_of(End::kFacetsCoarser);
  coarser.compared.coarser = {FaceId(1), FaceId(2), FaceId(3)};
  coarser.compared.allowed = {{SurfaceId(0), 7}};
  Outcome by_default = with_fault(with_failure(outcome_of(End::kCheckFailed), 2), 3);
  by_default.are_elements_automatic = by_default.are_any_crossing = true;
  Outcome offsets = outcome_of(End::kOffsetsChanged);
  offsets.offsets = IdVector<SurfaceId, double>(1, 0.25);
  Outcome impossible = with_fault(outcome_of(End::kOffsetsImpossible), 3);
  impossible.are_any_moved = true;
  Outcome arranged = outcome_of(End::kSurfaceReplaced);
  arranged.is_arranged = true;
  Outcome coarsened = outcome_of(End::kSurfaceReplaced);
  coarsened.is_coarsened = true;
  Outcome whole = with_failure(outcome_of(End::kCheckFailed), 2);
  whole.is_whole_wrong = true;
  Outcome nothing_cut = outcome_of(End::kNothingCut);
  nothing_cut.is_arranging_in_vain = true;
  const Decisions divided = *learn(first(), with_failure(outcome_of(End::kPatchesFailed), 2), {});
  return {
      {"details", first(), outcome_of(End::kSurfaceReplaced), "divide the surface without them"},
      {"cut_faces", first(), arranged, "divide the faces that were cut"},
      {"coarser_surface", first(), coarsened, "divide the coarser surface"},
      {"nothing_cut", divided, nothing_cut, "begin again with whole patches, and make the surface coarser first"},
      {"triangulation", first(), with_failure(outcome_of(End::kPatchesFailed), 2),
       "divide 2 input faces into smaller patches (step 1)"},
      {"in_vain", first(), outcome_of(End::kWorkInVain), "refine nothing until a result is verified"},
      {"floor_predicted", first(), outcome_of(End::kMinEdgeTooShort), "raise min_edge_length to 0.000976562"},
      {"floor_made", first(), too_many, "raise min_edge_length to 0.000976562"},
      {"floor_made_soon", first(), outcome_of(End::kTooManyMade), "raise min_edge_length to 0.000976562"},
      {"budget", first(), far_too_many, "stop refining at 999024 faces, apart from edges that must be cut"},
      {"gaps", first(), gaps, "no edges below 0.5 because of gaps"},
      {"coarser", first(), coarser, "keep 3 input faces as flat facets"},
      {"fault", first(), with_fault(with_failure(outcome_of(End::kCheckFailed), 2), 3),
       "remesh 1 input face of curved surfaces more finely"},
      {"fault_again", tightened, with_fault(with_failure(outcome_of(End::kCheckFailed), 2), 3),
       "keep 1 input face as flat facets"},
      {"fault_by_default", first(), by_default, "keep 1 input face as flat facets"},
      {"offsets", first(), offsets, "correct the offsets of curved surfaces (round 1)"},
      {"offsets_impossible", first(), impossible, "remesh 1 input face of curved surfaces more finely"},
      {"freeze", first(), with_failure(outcome_of(End::kCheckFailed), 2), "insert no points into 2 input faces"},
      {"frozen_in_vain", first(), with_failure(outcome_of(End::kCheckFailed), 2, true),
       "divide 2 input faces into smaller patches (step 1)"},
      {"whole", first(), whole, "divide 2 input faces into smaller patches (step 1)"},
      {"passes_unrefined", nothing_yet, outcome_of(End::kVerified),
       "refine what has never failed, insert no points into 1 input face"},
      {"rest_failed", rest, with_failure(outcome_of(End::kCheckFailed), 2, true),
       "refine nothing, insert no points into 2 input faces"},
      {"exhausted", on_last_rung, with_failure(outcome_of(End::kPatchesFailed), 2),
       "copy 2 input faces as they are, begin anew"},
  };
}

TEST(learn, decides_what_the_table_says) {
  for (const Row& row : rows()) {
    const std::optional<Decisions> next = learn(row.now, row.outcome, {});
    ASSERT_TRUE(next) << row.name;
    EXPECT_EQ(difference(row.now, *next), row.decided) << row.name;
  }
}

TEST(learn, decides_nothing_after_success) { EXPECT_FALSE(learn(first(), outcome_of(End::kVerified), {})); }

TEST(learn, what_fails_for_ever_ends) {
  // Whatever fails, and however often, something else is decided each time, until nothing is left.
  for (const bool was_joined : {false, true})
    for (const bool is_curved : {false, true})
      for (const End end : {End::kPatchesFailed, End::kCheckFailed}) {
        Outcome outcome = with_failure(outcome_of(end), 2);
        if (is_curved) outcome = with_fault(outcome, 3);
        outcome.was_any_joined = was_joined;
        std::optional<Decisions> decisions = first();
        int attempts = 0;
        while (decisions && attempts < 100) {
          ++attempts;
          const Decisions now = *decisions;
          // The patch is frozen once it was told to be, and curved patches are facets in the end.
          outcome.was_frozen[0] = are_marked(now.refinement.frozen, outcome.failed[0].faces) ? 1 : 0;
          if (is_curved && now.curved.rung_of(std::vector{FaceId(3)}) == CurvedRung::kFacet) outcome.faults.clear();
          decisions = learn(now, outcome, {});
          if (decisions) {
            EXPECT_FALSE(*decisions == now) << attempts;
          }
        }
        EXPECT_FALSE(decisions);
        EXPECT_GT(attempts, 2);
        EXPECT_LT(attempts, 30);
      }
}

TEST(learn, frozen_faces_stay_frozen_after_much_work_alone) {
  Decisions now = first();
  now.refinement.frozen.assign(kFaces, 0);
  now.refinement.frozen[7] = 1;
  const Outcome failed = with_failure(outcome_of(End::kCheckFailed), 2, true);
  EXPECT_TRUE(learn(now, failed, {})->refinement.frozen.empty());
  const Effort much{.triangles = kWorkBeforeFrozenStay};
  EXPECT_EQ(learn(now, failed, much)->refinement.frozen[7], 1);
}

TEST(learn, a_floor_that_was_found_stays_after_the_input_is_mended_anew) {
  Decisions now = first();
  for (int i = 0; i < 5; ++i) now.refinement.min_edge.record_too_many();
  Outcome failed = with_failure(outcome_of(End::kPatchesFailed), 2);
  failed.failed[0].is_kept = true;
  const std::optional<Decisions> next = learn(now, failed, {});
  ASSERT_TRUE(next);
  EXPECT_NE(next->mending, now.mending);
  EXPECT_EQ(next->refinement.min_edge.min_edge_length(), now.refinement.min_edge.min_edge_length());
  EXPECT_EQ(next->rungs, FaceRungs());
}

TEST(spent, counts_what_was_in_vain_and_not_what_had_only_too_many_faces) {
  Outcome outcome = outcome_of(End::kTooManyFaces);
  outcome.triangles = 500;
  outcome.search_steps = 30;
  outcome.size_steps = 20;
  outcome.faces = 1001;
  Effort effort = spent({}, first(), outcome);
  EXPECT_EQ(effort.triangles, 0u);
  EXPECT_EQ(effort.largest, 500u);
  EXPECT_EQ(effort.search_steps, 30u);
  EXPECT_EQ(effort.size_steps, 20u);
  outcome = with_failure(outcome_of(End::kCheckFailed), 2);
  outcome.triangles = 500;
  effort = spent(effort, first(), outcome);
  EXPECT_EQ(effort.triangles, 500u);
  EXPECT_EQ(effort.wrong, 1u);
  effort = for_another_surface(spent(effort, first(), outcome));
  EXPECT_EQ(effort.triangles, 1000u);
  EXPECT_EQ(effort.wrong, 1u) << "as far as another surface is concerned";
}

}  // namespace
}  // namespace remesh
