#include "core/refinement/attempts/surface_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/planes/projection.h"
#include "core/refinement/prediction/curved_prediction.h"
#include "core/refinement/rounds/oversized_triangles.h"
#include "core/refinement/segments/segment_table.h"

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

/// Returns the area of the surface itself, in model units squared.
double area_of(const Surface& surface, RunControl& control) {
  StopCheck check(control);
  double area = 0;
  std::vector<Vec3> loop;
  for (FaceId f(0); f.value < surface.face_count(); ++f.value) {
    check();
    loop.clear();
    for (const VertexId v : surface.face(f)) loop.push_back(surface.local[v]);
    area += 0.5 * norm(newell_normal(loop));
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

/// Raises the predictions for curved patches to the faces that these have if edges turn as far as they may.
void add_faces_by_turn(const TriangulatedPatches& triangulated, bool by_angle, Prediction& prediction,
                       RunControl& control) {
  for (PatchId p(0); p.value < triangulated.size(); ++p.value) {
    const double faces = faces_by_turn(triangulated.meshes[p], triangulated.charts[p], by_angle, control);
    const double more = std::max(0.0, faces - prediction.of_patch[p.value]);
    prediction.expected += more;
    prediction.of_patch[p.value] += static_cast<float>(more);
  }
}

/// Writes why triangles were left as they are, whatever they miss.
void override_reasons(const RefinementAttempt& attempt, std::vector<UnrefinedReason>& reasons) {
  if (attempt.is_by_budget) std::fill(reasons.begin(), reasons.end(), UnrefinedReason::kBudget);
  if (attempt.is_by_effort) std::fill(reasons.begin(), reasons.end(), UnrefinedReason::kEffort);
  if (attempt.is_cut_short)
    std::replace(reasons.begin(), reasons.end(), UnrefinedReason::kBudget, UnrefinedReason::kEffort);
}

}  // namespace

Goals SurfaceRefinement::goals(const RefinementChoices& choices) const {
  Goals goals = asked_;
  goals.min_edge_length = choices.min_edge.min_edge_length();
  if (goals.has_target()) goals.max_edge_length = sizes_.largest;
  return goals;
}

RefinementFacts SurfaceRefinement::facts() const {
  RefinementFacts facts;
  facts.are_goals_set = curved_.are_any || asked_.min_angle_deg > 0 || std::isfinite(asked_.max_edge_length) ||
                        std::isfinite(asked_.max_area) || asked_.proximity > 0 || asked_.gradation > 0 ||
                        asked_.has_target();
  facts.is_min_edge_automatic = is_min_edge_automatic();
  facts.max_faces = asked_.max_faces;
  facts.faces_without_min_edge = asked_.faces_without_min_edge;
  facts.predicted = predicted_;
  facts.aimed_over_target = sizes_.aimed_over_target;
  return facts;
}

Prediction SurfaceRefinement::predict_before(const PatchedSurface& on, RefinementChoices& choices,
                                             const TriangulatedPatches& triangulated,
                                             const std::optional<MadeFaces>& made) {
  if (made) choices = made->choices;
  const auto gaps = gap_search(on, triangulated);
  make_size_field(on, choices, 0, triangulated, gaps.get());
  Prediction prediction;
  if (made && made->of_patch.size() == triangulated.size()) {
    prediction.of_patch = made->of_patch;
  } else if (has_goals(choices)) {
    prediction = made ? predict_faces(triangulated, goals(choices), *sizes_.field, control_)
                      : predict_with_floor(on, choices, triangulated, gaps.get());
  }
  limit_to_proportion(prediction);
  // A result that misses its target by more than a little is corrected.
  if (asked_.target_faces > 0 && std::isfinite(sizes_.largest))
    prediction.expected = static_cast<double>(asked_.target_faces);
  if (made) prediction.expected = static_cast<double>(made->faces);
  const double sum = std::accumulate(prediction.of_patch.begin(), prediction.of_patch.end(), 0.0);
  const double factor = sum > 0 ? prediction.expected / sum : 1;
  for (float& share : prediction.of_patch) share = static_cast<float>(share * factor);
  return prediction;
}

/// Predicts the faces. If they are out of proportion and the floor may be chosen, a higher floor is chosen for them.
Prediction SurfaceRefinement::predict_with_floor(const PatchedSurface& on, RefinementChoices& choices,
                                                 const TriangulatedPatches& triangulated, const GapSearch* gaps) {
  // A floor may leave far fewer faces than are in proportion. So one is expected only where a prediction that is right
  // within this factor leaves no doubt of it.
  constexpr double kDoubt = 1.5;
  RefinementFacts known = facts();
  known.is_any_refined = true;
  known.max_faces = Goals::kNoLimit;
  for (;;) {
    Prediction prediction = predict_faces(triangulated, goals(choices), *sizes_.field, control_);
    if (triangulated.charts.has_curved())
      add_faces_by_turn(triangulated, asked_.min_angle_deg > 0, prediction, control_);
    AfterFaces after = after_faces(choices, whole(prediction.expected / kDoubt), false, known);
    if (!after.is_repeated) return prediction;
    choices = std::move(after.choices);
    make_size_field(on, choices, 0, triangulated, gaps);
  }
}

RefinementAttempt SurfaceRefinement::refine(const PatchedSurface& on, const RefinementChoices& choices,
                                            const Effort& effort, IdVector<PatchId, std::uint8_t> frozen,
                                            TriangulatedPatches& triangulated) {
  RefinementAttempt attempt;
  const std::uint64_t limit = facts().expected_limit();
  attempt.is_by_budget = is_budget_too_small(choices);
  attempt.is_by_effort = effort.is_spent(limit) || choices.part == RefinedPart::kGivenUp;
  if (attempt.is_by_budget || attempt.is_by_effort) frozen.assign(on.patches.count(), 1);
  attempt.frozen = std::move(frozen);
  if (!is_min_edge_automatic())
    attempt.max_in_vain =
        kWorkInVain.steps(std::max<std::uint64_t>(on.surface.face_count(), triangulated.triangle_count()), 0);
  // There are at most as many samples of sizes as faces, apart from a few.
  if (asked_.proximity > 0)
    control_.memory().set_output(std::min<std::uint64_t>(asked_.max_faces, SizeField::kMaxSamples));
  const auto gaps = gap_search(on, triangulated);
  // Where nothing is refined, it does not matter which sizes are aimed at.
  const bool is_any_refined = std::find(attempt.frozen.begin(), attempt.frozen.end(), 0) != attempt.frozen.end();
  if (gaps) find_smallest_gap(*gaps);
  if (is_any_refined) attempt.size_steps = make_size_field(on, choices, effort.size_steps, triangulated, gaps.get());
  const Goals goals = this->goals(choices);
  const SizeField one_size(goals.max_edge_length);
  const SizeField& sizes = is_any_refined ? *sizes_.field : one_size;
  const std::optional<SizeField> graded = sizes_without_floor(on, goals, triangulated);
  Prediction prediction = predict_now(goals, is_any_refined, triangulated);
  predicted_ = prediction.expected;
  if (is_any_refined && is_min_edge_surely_too_short(choices)) {
    attempt.end = RefinementAttempt::End::kMinEdgeTooShort;
    return attempt;
  }
  limit_to_proportion(prediction);
  if (is_any_refined && gaps && choices.coarsest == 0 &&
      prediction.expected > kFarTooMany * static_cast<double>(goals.max_faces)) {
    attempt.coarsest = equilateral_edge(area_of(on.surface, triangulated.meshes, control_) /
                                        (kEvenShare * static_cast<double>(goals.max_faces)));
    // Beside coordinates that are very large, the areas of all triangles may be 0.
    if (attempt.coarsest > 0) {
      attempt.end = RefinementAttempt::End::kGapsTooFine;
      return attempt;
    }
  }
  const double hopeless = std::max(kFewFaces, kHopeless * static_cast<double>(goals.max_faces));
  if (!choices.budget && !facts().may_change_min_edge(choices) &&
      (goals.max_faces == Goals::kNoLimit || std::floor(prediction.expected) > hopeless)) {
    attempt.end = RefinementAttempt::End::kTooManyMade;
    return attempt;
  }
  // The first attempt may make all faces that are allowed, and later ones what the bound on the work leaves.
  const std::uint64_t left = effort.left(limit), budget = choices.budget.value_or(first_budget(goals.max_faces));
  attempt.is_cut_short = effort.triangles > 0 && left < budget;
  Goals within_budget = goals;
  within_budget.max_faces = Goals::kNoLimit;
  // Half of what is left remains for yet another attempt, so that one of them is small enough to be worth its result.
  if (choices.budget) within_budget.max_faces = attempt.is_cut_short ? left / 2 : budget;
  if (goals.min_angle_deg > 0) within_budget.min_angle_deg += curved_.angle_margin;
  const std::uint64_t max_made =
      choices.budget ? Goals::kNoLimit : this->max_made(choices, effort, prediction.expected);
  control_.memory().set_output(
      std::max<std::uint64_t>(triangulated.triangle_count(), std::min(within_budget.max_faces, max_made)));
  SegmentTable segments(on.surface, triangulated, attempt.frozen, sizes, goals, control_);
  refuse_if_hopeless(least_faces(triangulated, attempt.frozen, segments, goals, sizes, control_));
  segments.plan_cuts(triangulated, sizes, goals, control_);
  std::optional<Refinement> refined =
      remesh::refine({on.surface, attempt.frozen, within_budget, sizes, prediction, max_made,
                      choices.is_thinning_quick ? Thinning::kQuick : Thinning::kFull},
                     std::move(segments), triangulated, control_);
  if (!refined) {
    attempt.end = RefinementAttempt::End::kTooManyMade;
    return attempt;
  }
  attempt.refinement = *std::move(refined);
  if (gaps || graded) {
    // If vertices are moved to keep a volume, the misses are needed before that.
    attempt.may_measure_later = curved_.angle_margin == 0;
    // An attempt with a budget may have too many faces, and its result is not needed then. Where patches cross,
    // vertices may have to be moved apart first.
    const bool may_be_too_many =
        is_min_edge_automatic() &&
        (choices.min_edge.may_try_another() || attempt.refinement.reason.size() > goals.faces_without_min_edge);
    attempt.are_sizes_unmeasured =
        attempt.may_measure_later && (effort.wrong > 0 || choices.budget || !on.crossing.empty() || may_be_too_many);
    if (!attempt.are_sizes_unmeasured)
      record_oversized_triangles(on.surface, triangulated.meshes, attempt.frozen,
                                 {goals, on.plane_tolerance, sizes, gaps.get(), graded ? &*graded : nullptr},
                                 attempt.refinement, control_);
  }
  override_reasons(attempt, attempt.refinement.reason);
  return attempt;
}

void SurfaceRefinement::measure_sizes(const PatchedSurface& on, const RefinementChoices& choices,
                                      const RefinementAttempt& attempt, Refinement& refined,
                                      TriangulatedPatches& triangulated) const {
  const Goals goals = this->goals(choices);
  // Gaps are measured between the patches as they were before refinement.
  refined.before.exchange_with(triangulated.meshes);
  const auto gaps = gap_search(on, triangulated);
  const std::optional<SizeField> graded = sizes_without_floor(on, goals, triangulated);
  refined.before.exchange_with(triangulated.meshes);
  // Without a field, nothing was refined, and sizes that were aimed at do not count.
  const SizeField one_size(goals.max_edge_length);
  record_oversized_triangles(
      on.surface, triangulated.meshes, attempt.frozen,
      {goals, on.plane_tolerance, sizes_.field ? *sizes_.field : one_size, gaps.get(), graded ? &*graded : nullptr},
      refined, control_);
  override_reasons(attempt, refined.reason);
}

Prediction SurfaceRefinement::predict_now(const Goals& goals, bool is_any_refined,
                                          const TriangulatedPatches& triangulated) {
  if (!is_any_refined) {
    Prediction same;
    for (const PatchMesh& patch : triangulated.meshes)
      same.of_patch.push_back(static_cast<float>(patch.mesh.triangle_count()));
    same.expected = static_cast<double>(triangulated.triangle_count());
    return same;
  }
  if (!sizes_.predicted) sizes_.predicted = predict_faces(triangulated, goals, *sizes_.field, control_);
  return *sizes_.predicted;
}

/// Returns whether gaps or short edges ask for so many faces that the floor can be raised before any attempt.
bool SurfaceRefinement::is_min_edge_surely_too_short(const RefinementChoices& choices) const {
  if (sizes_.field->is_uniform() || !facts().may_change_min_edge(choices) || choices.min_edge.is_known_to_fit())
    return false;
  if (predicted_ > kAsMany * choices.too_many_predicted) return true;
  return predicted_ > kSurelyTooMany * static_cast<double>(asked_.faces_without_min_edge);
}

/// Returns after how many triangles an attempt without a budget ends.
std::uint64_t SurfaceRefinement::max_made(const RefinementChoices& choices, const Effort& effort,
                                          double predicted) const {
  const auto far_more_than = [](std::uint64_t allowed) {
    const auto faces = static_cast<double>(allowed);
    const double beyond = std::min((kMaxMade - 1) * faces, std::max(kFewMore, (kMaxManyMade - 1) * faces));
    return allowed + whole(std::min(beyond, kMaxMadeBeyond));
  };
  if (facts().may_change_min_edge(choices)) return far_more_than(asked_.faces_without_min_edge);
  const std::uint64_t most = std::min(asked_.max_faces, kMaxFaces), max = far_more_than(most);
  const std::uint64_t made = std::clamp(whole(kMaxOfPredicted * std::floor(predicted)), most, max);
  return effort.triangles == 0 ? made : std::min(made, effort.left(facts().expected_limit()));
}

bool SurfaceRefinement::is_min_edge_automatic() const {
  return !curved_.are_finer && asked_.faces_without_min_edge < std::min(asked_.max_faces, kMaxFaces);
}

/// With a floor, there are hardly ever more faces than are in proportion.
void SurfaceRefinement::limit_to_proportion(Prediction& prediction) const {
  if (is_min_edge_automatic())
    prediction.expected = std::min(prediction.expected, static_cast<double>(asked_.faces_without_min_edge));
}

/// Throws if any result must have more faces than allowed. This is done before memory is allocated for them.
void SurfaceRefinement::refuse_if_hopeless(double least) const {
  const std::uint64_t most = std::min(asked_.max_faces, kMaxFaces);
  if (least > static_cast<double>(most))
    throw Error(Code::kOutputTooLarge, Stage::kRefinement,
                "with these sizes the result has at least " + count_text(least) + " faces, more than allowed")
        .for_option("max_output_faces")
        .with_limit(most);
}

/// Returns null without proximity. The result refers to the arguments.
std::unique_ptr<const GapSearch> SurfaceRefinement::gap_search(const PatchedSurface& on,
                                                               const TriangulatedPatches& triangulated) const {
  if (!(asked_.proximity > 0)) return nullptr;
  return std::make_unique<GapSearch>(on.surface, on.adjacency, on.patches, on.plane_tolerance, control_, &triangulated,
                                     GapSearch::Rules{asked_.min_gap, asked_.feature_angle_deg, on.crossing});
}

/// Returns a value only where gradation alone makes sizes vary.
std::optional<SizeField> SurfaceRefinement::sizes_without_floor(const PatchedSurface& on, const Goals& goals,
                                                                const TriangulatedPatches& triangulated) const {
  if (goals.proximity > 0 || !(goals.gradation > 0)) return std::nullopt;
  return SizeField::without_floor(on.surface, segment_ends(triangulated.meshes, control_), goals, control_);
}

void SurfaceRefinement::find_smallest_gap(const GapSearch& gaps) {
  if (!std::exchange(sizes_.is_smallest_gap_known, true))
    sizes_.smallest_gap = gaps.smallest(control_, asked_.max_faces_looked_for());
}

std::uint64_t SurfaceRefinement::make_size_field(const PatchedSurface& on, const RefinementChoices& choices,
                                                 std::uint64_t earlier_steps, const TriangulatedPatches& triangulated,
                                                 const GapSearch* gaps) {
  std::uint64_t steps = 0;
  if (!sizes_.without_floor || sizes_.coarsest != choices.coarsest) {
    if (gaps != nullptr) find_smallest_gap(*gaps);
    sizes_.field.reset();
    sizes_.coarsest = choices.coarsest;
    sizes_.without_floor.emplace(sizes_for(asked_, gaps, sizes_.coarsest, on, triangulated, earlier_steps, control_));
    steps = sizes_.without_floor->search_steps();
  }
  const double floor = choices.min_edge.min_edge_length();
  if (!sizes_.field || sizes_.field_floor != floor || sizes_.target != choices.target) {
    sizes_.predicted.reset();
    sizes_.target = choices.target;
    if (asked_.has_target()) choose_largest_edge(on, choices, triangulated);
    sizes_.field.emplace(sizes_.without_floor->within(goals(choices), control_));
    sizes_.field_floor = floor;
  }
  return steps;
}

/// Chooses the largest edge with which about as many faces are expected as the target asks for. It is infinity if the
/// other goals need as many.
void SurfaceRefinement::choose_largest_edge(const PatchedSurface& on, const RefinementChoices& choices,
                                            const TriangulatedPatches& triangulated) {
  sizes_.aimed_over_target = choices.target.scale;
  if (asked_.target_edge_length > 0) {
    sizes_.largest = kLargestOfMedian * asked_.target_edge_length * choices.target.scale;
    return;
  }
  sizes_.largest = HUGE_VAL;
  Goals goals = this->goals(choices);
  const auto predict = [&](double largest) {
    goals.max_edge_length = largest;
    return predict_faces(triangulated, goals, sizes_.without_floor->within(goals, control_), control_).expected;
  };
  // The faces that the largest edge adds to those of the other goals are in proportion to the area. Triangles of curved
  // patches have less of it than the surface, as long as they are large.
  const double others = predict(HUGE_VAL), area = area_of(on.surface, triangulated.meshes, control_);
  const double per_face = kMadeOfPredicted * area_of(on.surface, control_) / area;
  const auto expect = [&](double largest) { return others + per_face * std::max(0.0, predict(largest) - others); };
  const double target = static_cast<double>(asked_.target_faces), wanted = target * choices.target.scale;
  if (!(others < wanted) || !(area > 0)) {
    sizes_.aimed_over_target = others / target;
    return;
  }
  // Two edges are found between which the wanted one lies. Then one between them is found by the logarithms, since the
  // number of faces grows with the inverse square of the edge.
  constexpr double kNear = 0.01, kMargin = 0.05;
  constexpr int kMaxDoublings = 64, kMaxSteps = 6;
  double low = equilateral_edge(kFacesPerIdeal * area / wanted), high = low;
  double at_low = expect(low), at_high = at_low;
  for (int i = 0; i < kMaxDoublings && at_low < wanted; ++i) {
    high = std::exchange(low, low / 2);
    at_high = std::exchange(at_low, expect(low));
  }
  for (int i = 0; i < kMaxDoublings && at_high > wanted; ++i) {
    low = std::exchange(high, 2 * high);
    at_low = std::exchange(at_high, expect(high));
  }
  sizes_.largest = low;
  for (int step = 0; step < kMaxSteps && at_low > at_high; ++step) {
    const double share = std::log(at_low / wanted) / std::log(at_low / at_high);
    const double edge = low * std::pow(high / low, std::clamp(share, kMargin, 1 - kMargin));
    const double found = expect(edge);
    sizes_.largest = edge;
    if (std::abs(found - wanted) <= kNear * wanted) break;
    (found > wanted ? low : high) = edge;
    (found > wanted ? at_low : at_high) = found;
  }
}

double SurfaceRefinement::predict_with(const Goals& goals, const PatchedSurface& on, std::uint64_t earlier_steps,
                                       const TriangulatedPatches& triangulated) const {
  const bool have_same_sizes = goals.max_edge_length <= asked_.max_edge_length && goals.proximity == asked_.proximity &&
                               goals.gradation == asked_.gradation;
  const auto predict = [&](const SizeField& sizes) {
    return predict_faces(triangulated, goals, sizes.within(goals, control_), control_).expected;
  };
  if (sizes_.without_floor && have_same_sizes) return predict(*sizes_.without_floor);
  const bool is_search_long =
      sample_count() > kManySamples || (sizes_.without_floor && sizes_.without_floor->is_search_cut_short());
  if (goals.proximity > 0 && asked_.proximity > 0 && is_search_long)
    return predict(sizes_.without_floor->rescaled(asked_.proximity, goals, control_));
  const auto gaps = goals.proximity > 0 ? gap_search(on, triangulated) : nullptr;
  return predict(sizes_for(goals, gaps.get(), 0, on, triangulated, earlier_steps, control_));
}

}  // namespace remesh
