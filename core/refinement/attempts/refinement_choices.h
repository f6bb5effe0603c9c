/// The decisions about the refinement of a surface, and the work that attempts have taken. There is no geometry
/// here.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "core/base/work_bound.h"
#include "core/mesh/face_marks.h"
#include "core/refinement/attempts/min_edge_search.h"
#include "core/refinement/goals/goals.h"

namespace remesh {

/// Which patches an attempt refines.
enum class RefinedPart : std::uint8_t {
  kAll,         ///< all that are not frozen
  kNothingYet,  ///< none: the attempt shows whether a result passes the check without any refinement
  kRest,        ///< those that have never failed, after such a result has passed
  kGivenUp      ///< none, since what had never failed has failed as well
};

/// How the largest edge is chosen for a target. The first attempt shows by how much predictions are wrong.
struct TargetChoice {
  double scale = 1;  ///< the target is multiplied by this before the largest edge is chosen
  bool is_corrected = false;
  bool operator==(const TargetChoice&) const = default;
};

/// The choices for the refinement of one surface. An attempt follows them and changes nothing in them.
struct RefinementChoices {
  MinEdgeSearch min_edge;  ///< the floor under the lengths of edges
  TargetChoice target;
  /// Gaps do not make sizes smaller than this, in model units.
  double coarsest = 0;
  /// Refinement ends when it has made so many faces. Without a budget, many faces may be removed when patches are
  /// thinned out, so that they are no reason to leave anything undone.
  std::optional<std::uint64_t> budget;
  bool is_thinning_quick = false;  ///< there are so many faces that the best way to save some takes too long
  int retries = 0;                 ///< those with a budget; one that saved nothing counts more
  std::uint64_t last_faces = 0;    ///< those of the last result that was over its budget; 0: none yet
  /// The prediction for the last floor that an attempt has shown to be too low.
  double too_many_predicted = HUGE_VAL;
  RefinedPart part = RefinedPart::kAll;
  FaceMarks frozen;  ///< patches with only such faces stay as they are
  FaceMarks failed;  ///< the faces of all patches whose refinement has failed the check
  bool operator==(const RefinementChoices&) const = default;

  explicit RefinementChoices(const MinEdgeSearch& min_edge) : min_edge(min_edge) {}
};

/// The facts that an attempt knows about its surface and its goals.
struct RefinementFacts {
  bool are_goals_set = false;          ///< by the options, or since some patches are curved
  bool is_any_refined = false;         ///< not all patches are frozen
  bool is_min_edge_automatic = false;  ///< the floor is what limits the number of faces
  std::uint64_t max_faces = Goals::kNoLimit;
  std::uint64_t faces_without_min_edge = Goals::kNoLimit;  ///< see Goals
  /// The part of a target that the attempt has reached, 1 for all of it. It is empty without a target, and if no
  /// largest edge would bring the result nearer to it.
  std::optional<double> over_target;
  double aimed_over_target = 1;  ///< the part of the target that was expected with the largest edge
  double predicted = HUGE_VAL;   ///< in faces and without any limit but the floor; known once sizes are
  double shortest_made = 0;      ///< the shortest edge that refinement made, in model units; 0: not known
  bool operator==(const RefinementFacts&) const = default;

  bool has_goals(const RefinementChoices& choices) const {
    return are_goals_set && choices.part != RefinedPart::kNothingYet;
  }
  bool may_change_min_edge(const RefinementChoices& choices) const {
    return is_min_edge_automatic && !choices.budget && choices.min_edge.may_go_on();
  }
  /// Returns the number of faces that bounds the work of all attempts.
  std::uint64_t expected_limit() const { return is_min_edge_automatic ? faces_without_min_edge : max_faces; }
};

/// Returns the first budget, in faces. A part of what is allowed is reserved for cuts that neighbours make and for
/// points in chords, since another attempt would take as long as the first.
std::uint64_t first_budget(std::uint64_t max_faces);

/// Returns whether retries with smaller budgets have not helped, or not soon enough. Then nothing is refined.
bool is_budget_too_small(const RefinementChoices& choices);

/// A target is met if what is reached differs from it by no more than this share.
inline constexpr double kOffTarget = 0.1;

/// Returns whether a result misses its target, although another largest edge would bring it nearer.
bool is_off_target(const RefinementFacts& facts);

/// The choices after a result with a number of faces.
struct AfterFaces {
  RefinementChoices choices;
  bool is_repeated = false;  ///< there are too many faces, or another floor may do better
  bool counts = true;        ///< the work of the attempt counts, since its number of faces was not its only fault
};

/// Decides whether a result with so many faces needs another attempt. If it misses a target, the largest edge is chosen
/// anew, once. Otherwise, either the floor is changed, if the faces are out
/// of proportion (Goals::faces_without_min_edge), if the floor leaves worse angles than there were before, or if a
/// lower floor may serve as well. Or the budget is: the next attempt may exceed its budget by cuts that patches have to
/// make because their neighbours made them, by points in chords, or by cuts for sizes alone. Then the attempt after it
/// gets a smaller one.
AfterFaces after_faces(const RefinementChoices& now, std::uint64_t faces, bool are_angles_worse,
                       const RefinementFacts& facts);

/// Raises the floor, which an attempt has shown to be too low, or gives the next attempt a budget if no floor is left.
RefinementChoices after_too_many_made(const RefinementChoices& now, const RefinementFacts& facts);

/// The work of all attempts so far. A step is a triangle of a complete attempt. If half of the steps are spent on
/// results that failed the check, the next attempts refine nothing, until one of them passes. Then all is refined that
/// has never failed. The steps of searches for intersections in the checks have a bound of their own. Searches of the
/// usual length do not come near it.
/// Source: rules.md, Ladder.
struct Effort {
  std::uint64_t triangles = 0;                   ///< those of complete attempts that count
  std::uint64_t largest = 0;                     ///< the triangles of the largest attempt
  std::uint64_t search_steps = 0;                ///< those of the searches for intersections in the checks
  std::uint64_t size_steps = 0;                  ///< those of the searches for gaps, from which sizes are found
  std::uint64_t max_in_vain = WorkBound::kNone;  ///< more triangles than these are not spent on wrong results
  std::uint64_t wrong = 0;                       ///< the results that have failed the check

  /// Returns the steps that are left if a result may have so many faces.
  std::uint64_t left(std::uint64_t max_faces) const;
  /// Returns whether the next attempt has to leave all patches as they are.
  bool is_spent(std::uint64_t max_faces) const;
  /// Returns whether too much of the work was for results that failed the check.
  bool is_in_vain(std::uint64_t max_faces) const;
  bool operator==(const Effort&) const = default;
};

}  // namespace remesh
