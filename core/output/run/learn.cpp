#include "core/output/run/learn.h"

#include <algorithm>
#include <utility>

#include "core/base/work_bound.h"

namespace remesh {
namespace {

/// Forgets what was decided about patches, because others are made. What took much work to find out stays.
void forget_patches(RefinementChoices& refinement, const Effort& effort) {
  refinement.target = {};
  if (effort.triangles < kWorkBeforeFrozenStay) refinement.frozen.clear();
  refinement.last_faces = 0;
}

/// Copies faces verbatim that are on the last rung, or gives up joining. All else begins anew on the surface that comes
/// of that.
std::optional<Decisions> mended_otherwise(const Decisions& now, const Outcome& outcome,
                                          const std::vector<FaceId>& exhausted) {
  Decisions next(now.refinement.min_edge.again());
  next.mending = now.mending;
  const bool is_any_new = std::any_of(exhausted.begin(), exhausted.end(), [&](FaceId f) {
    return !are_marked(now.mending.keep_verbatim, {&f, 1});
  });
  mark(next.mending.keep_verbatim, exhausted, outcome.input_faces);
  if (is_any_new) return next;
  // Where sheets nearly touch, new vertices in faces, closed seams or new faces may be the reason why a result fails.
  if (!now.mending.is_joining_allowed || !outcome.was_any_joined) return std::nullopt;
  next.mending.is_joining_allowed = false;
  return next;
}

/// Takes failed patches a step up the ladder. If curved ones may be at fault, they take a step of their own.
std::optional<Decisions> one_step_up(Decisions next, const Outcome& outcome, const Effort& effort) {
  const Decisions now = next;
  if (next.refinement.part != RefinedPart::kAll) next.refinement.part = RefinedPart::kNothingYet;
  forget_patches(next.refinement, effort);
  if (!outcome.faults.empty()) {
    // Attempts take long where patches of the input cross, and where a min_edge_length is looked for. For a default,
    // not much of that work is spent in vain.
    const MinEdgeSearch& min_edge = now.refinement.min_edge;
    const bool has_found_floor =
        min_edge.min_edge_length() > min_edge.asked() && outcome.facts.may_change_min_edge(now.refinement);
    const bool is_patient = !outcome.are_elements_automatic || (!outcome.are_any_crossing && !has_found_floor);
    next.curved =
        after_faults(std::move(next.curved), outcome.faults, is_patient, outcome.are_any_moved, outcome.input_faces);
    return next;
  }
  if (const auto exhausted = exhausted_faces(now.rungs, outcome.failed); exhausted && !outcome.failed.empty())
    return mended_otherwise(now, outcome, *exhausted);
  next.rungs = one_rung_up(std::move(next.rungs), outcome.failed, outcome.input_faces);
  return next;
}

/// Leaves patches unrefined whose refinement has failed the check. If that does not help, all patches take a step.
std::optional<Decisions> after_check(Decisions next, const Outcome& outcome, const Effort& effort) {
  RefinementChoices& refinement = next.refinement;
  if (!outcome.is_whole_wrong)
    for (const FailedFaces& patch : outcome.failed) mark(refinement.failed, patch.faces, outcome.input_faces);
  // A curved patch cannot be left as it was triangulated: that is too far from its surface.
  if (outcome.faults.empty()) {
    if (outcome.facts.has_goals(refinement) && !outcome.is_whole_wrong) {
      bool is_any_new = false;
      for (std::size_t i = 0; i < outcome.failed.size(); ++i) {
        is_any_new = is_any_new || outcome.was_frozen[i] == 0;
        mark(refinement.frozen, outcome.failed[i].faces, outcome.input_faces);
      }
      if (is_any_new) return next;
    }
    if (refinement.part == RefinedPart::kRest) {
      refinement.part = RefinedPart::kGivenUp;
      return next;
    }
  }
  return one_step_up(std::move(next), outcome, effort);
}

/// Refines what has never failed, after a result without any refinement has passed.
std::optional<Decisions> after_success(Decisions next) {
  if (next.refinement.part != RefinedPart::kNothingYet) return std::nullopt;
  next.refinement.part = RefinedPart::kRest;
  next.refinement.frozen = next.refinement.failed;
  return next;
}

/// Goes on with a surface that a stage has put in the place of the last one.
Decisions on_other_surface(Decisions next, const Outcome& outcome) {
  if (outcome.is_arranged) {
    next.details.arranged = std::exchange(next.rungs, {});
    next.details.is_arranging_done = true;
  } else if (outcome.is_coarsened) {
    next.details.is_coarsened = next.details.is_coarsening_done = next.details.are_done = true;
  } else {
    next.details.replaced.push_back(std::exchange(next.rungs, {}));
  }
  next.curved = {};
  return next;
}

}  // namespace

std::optional<Decisions> learn(const Decisions& now, const Outcome& outcome, const Effort& effort) {
  Decisions next = now;
  next.details.is_arranging_done = now.details.is_arranging_done || outcome.is_arranging_in_vain;
  next.details.are_done = now.details.are_done || outcome.are_details_done;
  next.details.is_coarsening_done = now.details.is_coarsening_done || outcome.is_coarsening_in_vain;
  next.curved = after_comparison(std::move(next.curved), outcome.compared, outcome.input_faces);
  RefinementChoices& refinement = next.refinement;
  if (outcome.faces)
    refinement = after_faces(refinement, *outcome.faces, outcome.are_angles_worse, outcome.facts).choices;
  switch (outcome.end) {
    case Outcome::End::kSurfaceReplaced: return on_other_surface(std::move(next), outcome);
    case Outcome::End::kNothingCut: next.rungs = {}; return next;
    case Outcome::End::kPatchesFailed: return one_step_up(std::move(next), outcome, effort);
    case Outcome::End::kWorkInVain: refinement.part = RefinedPart::kNothingYet; return next;
    case Outcome::End::kMinEdgeTooShort: refinement.min_edge.record_too_many(); return next;
    case Outcome::End::kGapsTooFine: refinement.coarsest = outcome.coarsest; return next;
    case Outcome::End::kTooManyMade: refinement = after_too_many_made(refinement, outcome.facts); return next;
    case Outcome::End::kFacetsCoarser: forget_patches(refinement, effort); return next;
    case Outcome::End::kOffsetsImpossible:
      forget_patches(refinement, effort);
      next.curved =
          after_faults(std::move(next.curved), outcome.faults, true, outcome.are_any_moved, outcome.input_faces);
      return next;
    case Outcome::End::kOffsetsChanged:
      forget_patches(refinement, effort);
      next.curved.offsets.take(outcome.offsets);
      return next;
    case Outcome::End::kTooManyFaces: return next;
    case Outcome::End::kCheckFailed: return after_check(std::move(next), outcome, effort);
    case Outcome::End::kVerified: return after_success(std::move(next));
  }
  return std::nullopt;
}

Effort spent(const Effort& before, const Decisions& now, const Outcome& outcome) {
  Effort after = before;
  after.search_steps += outcome.search_steps;
  after.size_steps += std::min(outcome.size_steps, WorkBound::kNone - after.size_steps);
  after.largest = std::max(after.largest, outcome.triangles);
  if (outcome.max_in_vain) after.max_in_vain = *outcome.max_in_vain;
  // An attempt whose only fault was the number of its faces does not count.
  const bool counts =
      outcome.end != Outcome::End::kFacetsCoarser &&
      (!outcome.faces || after_faces(now.refinement, *outcome.faces, outcome.are_angles_worse, outcome.facts).counts);
  if (counts) after.triangles += outcome.triangles;
  const bool has_failed = outcome.end == Outcome::End::kCheckFailed || outcome.end == Outcome::End::kPatchesFailed;
  if (outcome.end == Outcome::End::kCheckFailed && outcome.faults.empty() && outcome.facts.has_goals(now.refinement))
    ++after.wrong;
  if (has_failed) after.wrong = std::max<std::uint64_t>(after.wrong, 1);
  return after;
}

Effort for_another_surface(const Effort& before) {
  Effort after = before;
  after.max_in_vain = WorkBound::kNone;
  after.wrong = before.triangles > 0 ? 1 : 0;
  return after;
}

}  // namespace remesh
