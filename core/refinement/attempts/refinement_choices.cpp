#include "core/refinement/attempts/refinement_choices.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/intersections/self_intersections.h"

namespace remesh {
namespace {

constexpr int kMaxRetries = 6;
constexpr int kRetriesInVain = 3;  ///< a retry that made no fewer faces counts as so many
/// One kReserve-th of the faces allowed is reserved.
constexpr std::uint64_t kReserve = 1024;
/// If more faces than these are allowed, it takes too long to look for the best way to save some of them.
constexpr double kFewFaces = 0x1p17;

/// An attempt with fewer triangles is not worth while.
constexpr std::uint64_t kMinAttempt = 1 << 10;
/// The searches for intersections in all checks together may take as many steps as this number of searches in failed
/// results as large as the largest so far, or of kMinSearched triangles.
constexpr std::uint64_t kSearches = 4, kMinSearched = 1 << 15;

}  // namespace

std::uint64_t first_budget(std::uint64_t max_faces) {
  return max_faces == Goals::kNoLimit ? max_faces : max_faces - max_faces / kReserve;
}

bool is_off_target(const RefinementFacts& facts) {
  return facts.over_target && !(std::abs(*facts.over_target - 1) <= kOffTarget);
}

bool is_budget_too_small(const RefinementChoices& choices) { return choices.retries > kMaxRetries; }

RefinementChoices after_too_many_made(const RefinementChoices& now, const RefinementFacts& facts) {
  RefinementChoices next = now;
  if (facts.may_change_min_edge(now)) {
    next.too_many_predicted = facts.predicted;
    next.min_edge.record_too_many(facts.shortest_made);
  } else {
    next.is_thinning_quick = true;
    next.budget = first_budget(facts.max_faces);
  }
  return next;
}

AfterFaces after_faces(const RefinementChoices& now, std::uint64_t faces, bool are_angles_worse,
                       const RefinementFacts& facts) {
  AfterFaces after{now};
  RefinementChoices& next = after.choices;
  if (!facts.has_goals(now)) return after;
  if (is_off_target(facts) && !now.target.is_corrected && now.budget.value_or(Goals::kNoLimit) == Goals::kNoLimit) {
    next.target = {facts.aimed_over_target / *facts.over_target, true};
    after.is_repeated = true;
    after.counts = false;
    return after;
  }
  const bool is_min_edge_chosen = facts.is_any_refined && facts.is_min_edge_automatic && !now.budget;
  const bool is_min_edge_too_short = faces > facts.faces_without_min_edge || are_angles_worse;
  if (is_min_edge_chosen && is_min_edge_too_short && now.min_edge.may_go_on()) {
    next = after_too_many_made(now, facts);
    after.is_repeated = true;
  } else if (is_min_edge_chosen && !is_min_edge_too_short) {
    after.is_repeated = next.min_edge.record_fit(faces);
  }
  if (after.is_repeated) {
    after.counts = false;
    return after;
  }
  if (faces <= facts.max_faces || is_budget_too_small(now)) return after;
  after.is_repeated = true;
  if (!now.budget) {
    // The attempt failed by its number of faces alone. The next one may make all faces that are allowed.
    next.budget = first_budget(facts.max_faces);
    next.is_thinning_quick = now.is_thinning_quick || static_cast<double>(facts.max_faces) > kFewFaces;
    after.counts = false;
    return after;
  }
  const bool is_in_vain = now.last_faces != 0 && faces >= now.last_faces;
  next.last_faces = faces;
  next.retries += is_in_vain ? kRetriesInVain : 1;
  // The faces that exceed a budget mostly grow with it. So each retry reserves a little more of it.
  const double share = static_cast<double>(facts.max_faces) / static_cast<double>(faces);
  constexpr double kReserved = 1.0 / 32;
  next.budget = static_cast<std::uint64_t>(static_cast<double>(*now.budget) * share * (1 - kReserved * next.retries));
  return after;
}

std::uint64_t Effort::left(std::uint64_t max_faces) const {
  WorkBound bound(kWorkOfAttempts.steps(0, max_faces));
  bound.take(triangles);
  return bound.left();
}

bool Effort::is_spent(std::uint64_t max_faces) const {
  const std::uint64_t searched = std::min(max_faces, std::max(largest, kMinSearched));
  return left(max_faces) < kMinAttempt || search_steps > kSearches * SearchLimits::few_steps_for(searched);
}

bool Effort::is_in_vain(std::uint64_t max_faces) const {
  // One failure is often mended at once, whatever it took.
  const bool is_much = wrong >= 2 && triangles > max_in_vain;
  return wrong > 0 && (is_much || triangles > left(max_faces)) && !is_spent(max_faces);
}

}  // namespace remesh
