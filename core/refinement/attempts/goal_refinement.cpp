#include "core/refinement/attempts/goal_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "core/base/stoppable.h"
#include "core/refinement/prediction/prediction.h"
#include "core/refinement/rounds/size_misses.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/gap_search.h"

namespace remesh {
namespace {

/// Converts to an integer. The limit of 2^62 is far beyond any result, so larger numbers are cut off there.
std::uint64_t whole(double faces) { return static_cast<std::uint64_t>(std::min(faces, 0x1p62)); }

/// Returns the area of all triangles, in model units squared.
double area_of(const Surface& surface, const PatchMeshes& meshes, RunControl& control) {
  StopCheck check(control);
  double area = 0;
  for (const PatchMesh& patch : meshes)
    for (std::uint32_t h = 0; h < patch.mesh.half_edge_count(); h += 3) {
      check();
      const auto corner = [&](std::uint32_t k) { return surface.local[patch.vertices[patch.mesh.from(h + k)]]; };
      area += 0.5 * norm(cross(corner(1) - corner(0), corner(2) - corner(0)));
    }
  return area * surface.unit * surface.unit;
}

/// Makes the field of sizes that the goals ask for.
SizeField sizes_for(const Goals& goals, const GapSearch* gaps, double coarsest, const PatchedSurface& on,
                    const TriangulatedPatches& triangulated, std::uint64_t earlier_steps, RunControl& control) {
  // With proximity, gradation is about the sizes that gaps ask for; around short segments, the bound on angles makes
  // edges grow gradually. Gradation without proximity is about short segments.
  std::vector<std::array<VertexId, 2>> segments;
  if (gaps == nullptr && goals.gradation > 0) segments = segment_ends(triangulated.meshes, control);
  if (gaps == nullptr && !(goals.gradation > 0)) return SizeField(goals.max_edge_length);
  return SizeField(on.surface, gaps, segments, goals, on.plane_tolerance, control, coarsest, earlier_steps);
}

std::string count_text(double count) {
  return count < 1e15 ? std::to_string(static_cast<std::uint64_t>(count)) : "10^15";
}

}  // namespace

bool GoalRefinement::has_goals() const {
  if (!effort_.has_goals()) return false;
  return are_any_curved_ || goals_.min_angle_deg > 0 || std::isfinite(goals_.max_edge_length) ||
         std::isfinite(goals_.max_area) || goals_.proximity > 0 || goals_.gradation > 0;
}

void GoalRefinement::predict_before(const PatchedSurface& on, const TriangulatedPatches& triangulated) {
  const auto gaps = gap_search(on, triangulated);
  const SizeField& sizes = size_field(on, triangulated, gaps.get());
  if (!has_goals()) return;
  // A floor may leave far fewer faces than are in proportion. So one is expected only where a prediction that is right
  // within this factor leaves no doubt of it.
  constexpr double kDoubt = 1.5;
  Prediction prediction = predict_closely(triangulated, goals_, sizes, control_);
  while (needs_other_floor(whole(prediction.expected / kDoubt), false))
    prediction = predict_closely(triangulated, goals_, size_field(on, triangulated, gaps.get()), control_);
  limit_to_proportion(prediction);
  double sum = 0;
  for (const float share : prediction.of_patch) sum += share;
  const double factor = sum > 0 ? prediction.expected / sum : 1;
  for (float& share : prediction.of_patch) share = static_cast<float>(share * factor);
  predicted_ = std::move(prediction);
}

Refinement GoalRefinement::refine(const PatchedSurface& on, const Ladder& ladder,
                                  std::span<const std::pair<PatchId, PatchId>> crossing,
                                  TriangulatedPatches& triangulated) {
  may_measure_later_ = are_sizes_unmeasured_ = false;
  set_crossing(crossing);
  frozen_.resize(on.patches.count(), 0);
  for (std::size_t p = 0; p < on.patches.count(); ++p)
    if (ladder.is_kept(on.patches.faces_of(PatchId(p))[0])) frozen_[PatchId(p)] = 1;
  if (is_budget_too_small() || effort_.is_used_up()) frozen_.assign(on.patches.count(), 1);
  if (!is_floor_automatic())
    effort_.limit_vain_work(std::max<std::uint64_t>(on.surface.face_count(), triangulated.triangle_count()));
  // There are at most as many samples of sizes as faces, apart from a few.
  if (goals_.proximity > 0)
    control_.memory().set_output(std::min<std::uint64_t>(goals_.max_faces, SizeField::kMaxSamples));
  const auto gaps = gap_search(on, triangulated);
  // Where nothing is refined, it does not matter which sizes are aimed at.
  const bool is_any_refined = std::find(frozen_.begin(), frozen_.end(), 0) != frozen_.end();
  const SizeField one_size(goals_.max_edge_length);
  if (gaps) find_smallest_gap(*gaps);
  const SizeField& sizes = is_any_refined ? size_field(on, triangulated, gaps.get()) : one_size;
  const std::optional<SizeField> graded = sizes_without_floor(on, triangulated);
  Prediction prediction = predict_attempt(on, triangulated, gaps.get(), is_any_refined);
  if (is_any_refined && gaps && sizes_.coarsest == 0 &&
      prediction.expected > kFarTooMany * static_cast<double>(goals_.max_faces)) {
    sizes_.coarsest = equilateral_edge(area_of(on.surface, triangulated.meshes, control_) /
                                       (kEvenShare * static_cast<double>(goals_.max_faces)));
    sizes_.without_floor.reset();
    prediction = predict_attempt(on, triangulated, gaps.get(), is_any_refined);
  }
  roughly_predicted_ = whole(prediction.expected);
  const auto attempt = [&](std::uint64_t budget, std::uint64_t max_made) {
    control_.memory().set_output(std::max<std::uint64_t>(triangulated.triangle_count(), std::min(budget, max_made)));
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
  const bool is_cut_short = effort_.taken() > 0 && effort_.left() < budget_;
  const auto measured = [&](Refinement refined) {
    overridden_ = {is_budget_too_small(), effort_.is_used_up(), is_cut_short};
    if (gaps || graded) {
      // If vertices are moved to keep a volume, the misses are needed before that.
      may_measure_later_ = angle_margin_ == 0;
      // An attempt with a budget may have too many faces, and its result is not needed then. Where patches cross,
      // vertices may have to be moved apart first.
      const bool may_be_too_many =
          is_floor_automatic() && (floors_.may_try_another() || refined.reason.size() > goals_.faces_without_floor);
      are_sizes_unmeasured_ =
          may_measure_later_ && (effort_.is_any_wrong() || needs_budget_ || !crossing.empty() || may_be_too_many);
      if (!are_sizes_unmeasured_)
        note_size_misses(on.surface, triangulated.meshes, frozen_,
                         {goals_, on.plane_tolerance, sizes, gaps.get(), graded ? &*graded : nullptr}, refined,
                         control_);
    }
    overridden_.write_to(refined.reason);
    effort_.take(refined.reason.size());
    return refined;
  };
  if (!needs_budget_ && !is_worth_trying_without_budget()) needs_budget_ = is_hopeless_ = true;
  if (!needs_budget_) {
    for (;;) {
      if (auto refined = attempt(Goals::kNoLimit, max_made())) return measured(*std::move(refined));
      if (!may_change_floor()) break;
      change_floor();
      prediction = predict_attempt(on, triangulated, gaps.get(), is_any_refined);
      roughly_predicted_ = whole(prediction.expected);
    }
    needs_budget_ = is_hopeless_ = true;
  }
  // Half of what is left remains for yet another attempt, so that one of them is small enough to be worth its result.
  return measured(attempt(is_cut_short ? effort_.left() / 2 : budget_, Goals::kNoLimit).value());
}

Prediction GoalRefinement::predict_now(const TriangulatedPatches& triangulated, bool is_any_refined) {
  if (!is_any_refined) {
    Prediction same;
    for (const PatchMesh& patch : triangulated.meshes)
      same.of_patch.push_back(static_cast<float>(patch.mesh.triangle_count()));
    same.expected = static_cast<double>(triangulated.triangle_count());
    return same;
  }
  if (!sizes_.predicted || sizes_.predicted_floor != goals_.min_edge_length) {
    sizes_.predicted = predict_roughly(triangulated, goals_, *sizes_.field, control_);
    sizes_.predicted_floor = goals_.min_edge_length;
  }
  return *sizes_.predicted;
}

/// Predicts roughly how many faces the next attempt makes. Where gaps or short edges ask for far more faces than are in
/// proportion, floors are raised before any attempt.
Prediction GoalRefinement::predict_attempt(const PatchedSurface& on, const TriangulatedPatches& triangulated,
                                           const GapSearch* gaps, bool is_any_refined) {
  for (;;) {
    if (is_any_refined) size_field(on, triangulated, gaps);
    Prediction prediction = predict_now(triangulated, is_any_refined);
    const bool do_sizes_vary = is_any_refined && !sizes_.field->is_uniform();
    const auto are_surely_too_many = [&] {
      if (prediction.expected > kAsMany * too_many_predicted_) return true;
      const double in_proportion = kSurelyTooMany * static_cast<double>(goals_.faces_without_floor);
      return prediction.expected > in_proportion &&
             predict_closely(triangulated, goals_, *sizes_.field, control_).expected > in_proportion;
    };
    if (!do_sizes_vary || !may_change_floor() || floors_.is_between() || !are_surely_too_many()) {
      unlimited_prediction_ = prediction.expected;
      limit_to_proportion(prediction);
      return prediction;
    }
    floors_.note_too_many();
    goals_.min_edge_length = floors_.floor();
  }
}

void GoalRefinement::Overridden::write_to(std::vector<UnrefinedReason>& reasons) const {
  if (by_budget) std::fill(reasons.begin(), reasons.end(), UnrefinedReason::kBudget);
  if (by_effort) std::fill(reasons.begin(), reasons.end(), UnrefinedReason::kEffort);
  if (is_cut_short) std::replace(reasons.begin(), reasons.end(), UnrefinedReason::kBudget, UnrefinedReason::kEffort);
}

void GoalRefinement::measure_sizes(const PatchedSurface& on, TriangulatedPatches& triangulated,
                                   Refinement& refined) const {
  // Gaps are measured between the patches as they were before refinement.
  refined.before.exchange_with(triangulated.meshes);
  const auto gaps = gap_search(on, triangulated);
  const std::optional<SizeField> graded = sizes_without_floor(on, triangulated);
  refined.before.exchange_with(triangulated.meshes);
  // Without a field, nothing was refined, and sizes that were aimed at do not count.
  const SizeField one_size(goals_.max_edge_length);
  note_size_misses(
      on.surface, triangulated.meshes, frozen_,
      {goals_, on.plane_tolerance, sizes_.field ? *sizes_.field : one_size, gaps.get(), graded ? &*graded : nullptr},
      refined, control_);
  overridden_.write_to(refined.reason);
}

bool GoalRefinement::is_worth_trying_without_budget() const {
  if (may_change_floor()) return true;
  return goals_.max_faces != Goals::kNoLimit &&
         static_cast<double>(roughly_predicted_) <=
             std::max(kFewFaces, kHopeless * static_cast<double>(goals_.max_faces));
}

/// Returns after how many triangles an attempt without a budget ends.
std::uint64_t GoalRefinement::max_made() const {
  const auto far_more_than = [](std::uint64_t allowed) {
    const auto faces = static_cast<double>(allowed);
    const double beyond = std::min((kMaxMade - 1) * faces, std::max(kFewMore, (kMaxManyMade - 1) * faces));
    return allowed + whole(std::min(beyond, kMaxMadeBeyond));
  };
  if (may_change_floor()) return far_more_than(goals_.faces_without_floor);
  const std::uint64_t most = std::min(goals_.max_faces, kMaxFaces), max = far_more_than(most);
  const std::uint64_t made = std::clamp(whole(kMaxOfPredicted * static_cast<double>(roughly_predicted_)), most, max);
  return effort_.taken() == 0 ? made : std::min(made, effort_.left());
}

/// Returns whether the floor under the lengths of edges is what limits the number of faces. Faces of curved patches
/// that are finer than the input's facets are asked for, so their number is no reason for a floor.
bool GoalRefinement::is_floor_automatic() const {
  return !are_finer_ && goals_.faces_without_floor < std::min(goals_.max_faces, kMaxFaces);
}

bool GoalRefinement::may_change_floor() const { return is_floor_automatic() && !needs_budget_ && floors_.may_go_on(); }

/// With a floor, there are hardly ever more faces than are in proportion.
void GoalRefinement::limit_to_proportion(Prediction& prediction) const {
  if (is_floor_automatic())
    prediction.expected = std::min(prediction.expected, static_cast<double>(goals_.faces_without_floor));
}

void GoalRefinement::change_floor() {
  too_many_predicted_ = unlimited_prediction_;
  floors_.note_too_many();
  goals_.min_edge_length = floors_.floor();
}

/// Returns whether there is another floor to be tried after so many faces or such angles, and takes it.
bool GoalRefinement::needs_other_floor(std::uint64_t faces, bool are_angles_worse) {
  if (!is_floor_automatic() || needs_budget_) return false;
  if (faces > goals_.faces_without_floor || are_angles_worse) {
    if (!floors_.may_go_on()) return false;
    change_floor();
    return true;
  }
  if (!floors_.note_fit(faces)) return false;
  goals_.min_edge_length = floors_.floor();
  return true;
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
  return std::make_unique<GapSearch>(on.surface, on.adjacency, on.patches, on.plane_tolerance, control_, &triangulated,
                                     GapSearch::Rules{goals_.min_gap, goals_.feature_angle_deg, crossing_});
}

/// Returns a value only where gradation alone makes sizes vary.
std::optional<SizeField> GoalRefinement::sizes_without_floor(const PatchedSurface& on,
                                                             const TriangulatedPatches& triangulated) const {
  if (goals_.proximity > 0 || !(goals_.gradation > 0)) return std::nullopt;
  return SizeField::without_floor(on.surface, segment_ends(triangulated.meshes, control_), goals_, control_);
}

void GoalRefinement::find_smallest_gap(const GapSearch& gaps) {
  if (!std::exchange(sizes_.is_smallest_gap_known, true))
    sizes_.smallest_gap = gaps.smallest(control_, goals_.max_faces);
}

const SizeField& GoalRefinement::size_field(const PatchedSurface& on, const TriangulatedPatches& triangulated,
                                            const GapSearch* gaps) {
  if (!sizes_.without_floor) {
    if (gaps != nullptr) find_smallest_gap(*gaps);
    sizes_.predicted.reset();
    sizes_.field.reset();
    Goals goals = goals_;
    goals.min_edge_length = asked_floor_;
    sizes_.without_floor.emplace(
        sizes_for(goals, gaps, sizes_.coarsest, on, triangulated, effort_.size_steps(), control_));
    effort_.take_sizes(sizes_.without_floor->search_steps());
  }
  if (!sizes_.field || sizes_.field_floor != goals_.min_edge_length) {
    sizes_.field.emplace(sizes_.without_floor->with_floor(goals_, control_));
    sizes_.field_floor = goals_.min_edge_length;
  }
  return *sizes_.field;
}

double GoalRefinement::predict_with(const Goals& goals, const PatchedSurface& on,
                                    const TriangulatedPatches& triangulated) const {
  const bool have_same_sizes = goals.max_edge_length == goals_.max_edge_length && goals.proximity == goals_.proximity &&
                               goals.gradation == goals_.gradation;
  const auto predict = [&](const SizeField& sizes) {
    return predict_roughly(triangulated, goals, sizes.with_floor(goals, control_), control_).expected;
  };
  if (sizes_.without_floor && have_same_sizes) return predict(*sizes_.without_floor);
  const bool is_search_long =
      sample_count() > kManySamples || (sizes_.without_floor && sizes_.without_floor->is_search_cut_short());
  if (goals.proximity > 0 && goals_.proximity > 0 && is_search_long)
    return predict(sizes_.without_floor->rescaled(goals_.proximity, goals, control_));
  const auto gaps = goals.proximity > 0 ? gap_search(on, triangulated) : nullptr;
  return predict(sizes_for(goals, gaps.get(), 0, on, triangulated, effort_.size_steps(), control_));
}

bool GoalRefinement::is_over_budget(std::uint64_t faces, bool are_angles_worse) {
  const bool is_any_refined = has_goals() && std::find(frozen_.begin(), frozen_.end(), 0) != frozen_.end();
  if (is_any_refined && needs_other_floor(faces, are_angles_worse)) {
    effort_.give_back_last();
    return true;
  }
  if (!has_goals() || faces <= goals_.max_faces || is_budget_too_small()) return false;
  if (!std::exchange(needs_budget_, true)) {
    // The attempt failed by its number of faces alone. The next one may make all faces that are allowed. If these are
    // many, it takes too long to look for the best way to save some of them.
    is_hopeless_ = is_hopeless_ || static_cast<double>(goals_.max_faces) > kFewFaces;
    effort_.give_back_last();
    return true;
  }
  const bool is_in_vain = last_faces_ != 0 && faces >= last_faces_;
  last_faces_ = faces;
  retries_ += is_in_vain ? kRetriesInVain : 1;
  // The faces that exceed a budget mostly grow with it. So each retry reserves a little more of it.
  const double share = static_cast<double>(goals_.max_faces) / static_cast<double>(faces);
  constexpr double kReserved = 1.0 / 32;
  budget_ = static_cast<std::uint64_t>(static_cast<double>(budget_) * share * (1 - kReserved * retries_));
  return true;
}

bool GoalRefinement::goes_on_with_the_rest() {
  if (!effort_.goes_on_with_the_rest()) return false;
  frozen_.clear();
  return true;
}

bool GoalRefinement::freeze(const std::vector<PatchId>& failed, std::size_t count) {
  if (!has_goals()) return false;
  effort_.note_wrong();
  frozen_.resize(count, 0);
  bool is_new = false;
  for (const PatchId p : failed) {
    is_new = is_new || frozen_[p] == 0;
    frozen_[p] = 1;
  }
  return is_new;
}

}  // namespace remesh
