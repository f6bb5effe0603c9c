#include "core/refinement/goal_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "core/refinement/gap_search.h"
#include "core/refinement/prediction.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_misses.h"

namespace remesh {
namespace {

constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

/// Converts to an integer. The limit of 2^62 is far beyond any result, so larger numbers are cut off there.
std::uint64_t whole(double faces) { return static_cast<std::uint64_t>(std::min(faces, 0x1p62)); }

std::string count_text(double count) {
  return count < 1e15 ? std::to_string(static_cast<std::uint64_t>(count)) : "10^15";
}

}  // namespace

bool GoalRefinement::has_goals() const {
  return are_any_curved_ || goals_.min_angle_deg > 0 || std::isfinite(goals_.max_edge_length) ||
         std::isfinite(goals_.max_area) || goals_.proximity > 0 || goals_.gradation > 0;
}

std::uint64_t GoalRefinement::predict_faces(const PatchedSurface& on, const TriangulatedPatches& triangulated) {
  const auto gaps = gap_search(on, triangulated);
  const SizeField& sizes = size_field(on, triangulated, gaps.get());
  if (!has_goals()) return predicted_faces_;
  Prediction prediction = predict(triangulated, goals_, sizes, control_);
  predicted_faces_ = whole(prediction.expected);
  // The patches' own shares leave out what comes from cuts that other patches need.
  double sum = 0;
  for (const float share : prediction.of_patch) sum += share;
  const double factor = sum > 0 ? prediction.expected / sum : 1;
  for (float& share : prediction.of_patch) share = static_cast<float>(share * factor);
  predicted_of_patch_ = std::move(prediction.of_patch);
  return predicted_faces_;
}

Refinement GoalRefinement::refine(const PatchedSurface& on, const Ladder& ladder,
                                  std::span<const std::pair<PatchId, PatchId>> crossing,
                                  TriangulatedPatches& triangulated) {
  frozen_.resize(on.patches.count(), 0);
  for (std::size_t p = 0; p < on.patches.count(); ++p)
    if (ladder.is_kept(on.patches.faces_of(PatchId(p))[0])) frozen_[PatchId(p)] = 1;
  if (is_budget_too_small() || is_effort_spent()) frozen_.assign(on.patches.count(), 1);
  // There are at most as many samples of sizes as faces, apart from a few.
  if (goals_.proximity > 0)
    control_.memory().set_output(std::min<std::uint64_t>(goals_.max_faces, SizeField::kMaxSamples));
  const auto gaps = gap_search(on, triangulated);
  const SizeField& sizes = size_field(on, triangulated, gaps.get());
  const std::optional<SizeField> graded = sizes_without_floor(on, triangulated);
  const Prediction prediction = predict(triangulated, goals_, sizes, control_);
  predicted_faces_ = whole(prediction.expected);
  const auto attempt = [&](std::uint64_t budget, std::uint64_t max_made) {
    control_.memory().set_output(std::min(budget, max_made));
    SegmentTable segments(on.surface, triangulated, frozen_, sizes, goals_, control_);
    refuse_if_hopeless(least_faces(triangulated, frozen_, segments, goals_, sizes, control_));
    segments.plan_cuts(triangulated, sizes, goals_, control_);
    Goals within_budget = goals_;
    within_budget.max_faces = budget;
    if (goals_.min_angle_deg > 0) within_budget.min_angle_deg += angle_margin_;
    const Thinning thinning = is_hopeless_ ? Thinning::kQuick : Thinning::kFull;
    return remesh::refine({on.surface, frozen_, within_budget, sizes, prediction, max_made, thinning},
                          std::move(segments), triangulated, control_);
  };
  // The first attempt may make all faces that are allowed, and later ones what the bound on the work leaves.
  const bool is_cut_short = work_.taken() > 0 && work_.left() < budget_;
  const auto measured = [&](Refinement refined) {
    if (gaps || graded)
      note_size_misses(on.surface, triangulated.meshes, frozen_,
                       {goals_, on.plane_tolerance, sizes, gaps.get(), graded ? &*graded : nullptr, crossing}, refined,
                       control_);
    if (is_budget_too_small()) std::fill(refined.reason.begin(), refined.reason.end(), UnrefinedReason::kBudget);
    if (is_effort_spent()) std::fill(refined.reason.begin(), refined.reason.end(), UnrefinedReason::kEffort);
    if (is_cut_short)
      std::replace(refined.reason.begin(), refined.reason.end(), UnrefinedReason::kBudget, UnrefinedReason::kEffort);
    work_.take(refined.reason.size());
    return refined;
  };
  if (!needs_budget_ && !is_worth_trying_without_budget()) needs_budget_ = is_hopeless_ = true;
  if (!needs_budget_) {
    if (auto refined = attempt(kNoLimit, max_made())) return measured(*std::move(refined));
    needs_budget_ = is_hopeless_ = true;
  }
  return measured(attempt(is_cut_short ? work_.left() : budget_, kNoLimit).value());
}

bool GoalRefinement::is_worth_trying_without_budget() const {
  return goals_.max_faces != kNoLimit && static_cast<double>(predicted_faces_) <=
                                             std::max(kFewFaces, kHopeless * static_cast<double>(goals_.max_faces));
}

/// Returns after how many triangles an attempt without a budget ends.
std::uint64_t GoalRefinement::max_made() const {
  const std::uint64_t most = std::min(goals_.max_faces, kMaxFaces);
  const std::uint64_t max = most + std::min((kMaxMade - 1) * most, kMaxMadeBeyond);
  const std::uint64_t made = std::clamp(whole(kMaxOfPredicted * static_cast<double>(predicted_faces_)), most, max);
  return work_.taken() == 0 ? made : std::min(made, work_.left());
}

/// Throws if any result must have more faces than allowed. This is done before memory is allocated for them.
void GoalRefinement::refuse_if_hopeless(double least) const {
  const std::uint64_t most = std::min(goals_.max_faces, kMaxFaces);
  if (least > static_cast<double>(most))
    throw Error(Code::kOutputTooLarge, Stage::kRefinement,
                "with these sizes the result has at least " + count_text(least) + " faces, more than allowed")
        .for_option("max_output_faces")
        .with_limit(most);
}

std::unique_ptr<const GapSearch> GoalRefinement::gap_search(const PatchedSurface& on,
                                                            const TriangulatedPatches& triangulated) const {
  if (!(goals_.proximity > 0)) return nullptr;
  return std::make_unique<GapSearch>(on.surface, on.adjacency, on.patches, on.plane_tolerance, control_, &triangulated);
}

/// Returns a value only where gradation alone makes sizes vary.
std::optional<SizeField> GoalRefinement::sizes_without_floor(const PatchedSurface& on,
                                                             const TriangulatedPatches& triangulated) const {
  if (goals_.proximity > 0 || !(goals_.gradation > 0)) return std::nullopt;
  return SizeField::without_floor(on.surface, segment_ends(triangulated.meshes, control_), goals_, control_);
}

const SizeField& GoalRefinement::size_field(const PatchedSurface& on, const TriangulatedPatches& triangulated,
                                            const GapSearch* gaps) {
  if (sizes_) return *sizes_;
  if (gaps != nullptr) smallest_gap_ = gaps->smallest(control_, goals_.max_faces);
  // With proximity, gradation is about the sizes that gaps ask for; around short segments, the bound on angles makes
  // edges grow gradually. Gradation without proximity is about short segments.
  std::vector<std::array<VertexId, 2>> segments;
  if (gaps == nullptr && goals_.gradation > 0) segments = segment_ends(triangulated.meshes, control_);
  if (gaps != nullptr || goals_.gradation > 0)
    sizes_.emplace(on.surface, gaps, segments, goals_, on.plane_tolerance, control_);
  else
    sizes_.emplace(goals_.max_edge_length);
  return *sizes_;
}

bool GoalRefinement::is_over_budget(std::uint64_t faces) {
  if (!has_goals() || faces <= goals_.max_faces || is_budget_too_small()) return false;
  if (!std::exchange(needs_budget_, true)) return true;
  const bool is_in_vain = last_faces_ != 0 && faces >= last_faces_;
  last_faces_ = faces;
  retries_ += is_in_vain ? kRetriesInVain : 1;
  // The faces that exceed a budget mostly grow with it. So each retry reserves a little more of it.
  const double share = static_cast<double>(goals_.max_faces) / static_cast<double>(faces);
  constexpr double kReserved = 1.0 / 32;
  budget_ = static_cast<std::uint64_t>(static_cast<double>(budget_) * share * (1 - kReserved * retries_));
  return true;
}

bool GoalRefinement::freeze(const std::vector<PatchId>& failed) {
  if (!has_goals()) return false;
  bool is_new = false;
  for (const PatchId p : failed) {
    is_new = is_new || frozen_[p] == 0;
    frozen_[p] = 1;
  }
  return is_new;
}

}  // namespace remesh
