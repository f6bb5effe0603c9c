/// Runs refinement: it makes attempts within a budget, and freezes patches whose refinement fails.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/work_bound.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/ladder.h"
#include "core/patches/triangulated_patches.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goals.h"
#include "core/refinement/rounds.h"
#include "core/refinement/size_field.h"

namespace remesh {

/// Refinement gets a surface that is divided into patches.
struct PatchedSurface {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  double plane_tolerance;  ///< model units
};

/// Refines one surface in one or more attempts, and remembers what the attempts so far have shown.
class GoalRefinement {
 public:
  /// If `goals` sets no goal, nothing is refined.
  /// Input: `taken` is the work that attempts at the surface took before its faces were mended anew.
  GoalRefinement(const Goals& goals, RunControl& control, std::uint64_t taken = 0)
      : goals_(goals), budget_(goals.max_faces), control_(control), work_(kWorkOfAttempts.steps(0, goals.max_faces)) {
    work_.take(taken);
    if (budget_ != std::numeric_limits<std::uint64_t>::max()) budget_ -= budget_ / kReserve;
  }

  const Goals& goals() const { return goals_; }
  bool has_goals() const;
  /// Returns the number of triangles that all attempts so far have refined.
  std::uint64_t work_taken() const { return work_.taken(); }
  /// Tells whether some patches are curved. These have to be refined even if there is no other goal.
  void set_curved(bool are_any_curved) { are_any_curved_ = are_any_curved; }
  /// Makes refinement aim at larger angles than are asked for, by some degrees. Vertices are to be moved after it.
  void set_angle_margin(double degrees) { angle_margin_ = degrees; }
  /// Returns the number of faces that the last attempt predicted.
  std::uint64_t predicted_faces() const { return predicted_faces_; }
  /// Returns the smallest distance from a facet to another that is not its neighbour, in model units. It is known only
  /// with goals.proximity.
  std::optional<double> smallest_gap() const { return smallest_gap_; }

  /// Predicts how many faces refinement will make of these triangles.
  std::uint64_t predict_faces(const PatchedSurface& on, const TriangulatedPatches& triangulated);
  /// Returns how the faces that predict_faces predicted are shared out among the patches. Their sum is that number.
  /// Empty without goals.
  const std::vector<float>& predicted_of_patch() const { return predicted_of_patch_; }

  /// Refines the triangles of all patches, except patches that the ladder takes verbatim and frozen patches.
  /// Input:  `crossing` lists the pairs of patches that cross or touch each other in the input. The smaller id of a
  ///         pair comes first, and the pairs are sorted.
  /// Errors: kOutputTooLarge - no result with these sizes can have as few faces as are allowed.
  Refinement refine(const PatchedSurface& on, const Ladder& ladder,
                    std::span<const std::pair<PatchId, PatchId>> crossing, TriangulatedPatches& triangulated);
  /// Has one entry per patch, which is not 0 if the last refinement had to leave the patch and its boundary as they
  /// were.
  const IdVector<PatchId, std::uint8_t>& frozen() const { return frozen_; }

  /// Returns whether a result with so many faces needs another attempt, and adapts the budget for that attempt. The
  /// first attempt has no budget as long as it does not make far more triangles than allowed: many of them are removed
  /// when patches are thinned out, so they are no reason to leave anything undone. The next attempt may exceed its
  /// budget by cuts that patches have to make because their neighbours made them, by points in chords, or by cuts for
  /// sizes alone. Then the attempt after it gets a smaller budget. If that does not help, or not soon enough, nothing
  /// is refined.
  bool is_over_budget(std::uint64_t faces);

  /// Freezes patches whose refinement failed the check: they stay as they were before it. Returns whether any of them
  /// was not frozen before.
  bool freeze(const std::vector<PatchId>& failed);
  /// Freezes patches before the next attempt, which is at a surface with so many patches.
  void freeze_before(std::size_t patches, const std::vector<PatchId>& those) {
    frozen_.resize(patches, 0);
    freeze(those);
  }
  /// Forgets what is known of the patches. After a step of the ladder the patches are others.
  void thaw() {
    frozen_.clear();
    sizes_.reset();
    last_faces_ = 0;
  }

 private:
  /// An attempt without a budget ends when it makes more than kMaxMade times the faces allowed, or kMaxMadeBeyond more
  /// than these, which would take a few GB of memory. See experiments.md, Prediction.
  static constexpr std::uint64_t kMaxMade = 4, kMaxMadeBeyond = std::uint64_t{1} << 23;
  /// It also ends when it makes more faces than allowed and kMaxOfPredicted times those that are predicted. Thinning
  /// out leaves a third at least, so the prediction was far too low, and nothing tells that there is an end at all.
  static constexpr double kMaxOfPredicted = 4;
  /// An attempt without a budget is not worth while if more than kHopeless times the faces allowed are predicted. Up to
  /// kFewFaces it is tried in any case, for two reasons: where boundaries are locked or edges must not be short,
  /// predictions may be far too high, and it takes a second at most.
  static constexpr double kHopeless = 2, kFewFaces = 0x1p17;
  static constexpr int kMaxRetries = 6;
  static constexpr int kRetriesInVain = 3;  ///< a retry that made no fewer faces counts as so many
  /// One kReserve-th of the faces allowed is reserved for what comes when the budget is spent: cuts that neighbours
  /// made, and points in chords. Without it, the result might exceed the limit, and another attempt would take as long
  /// as the first.
  static constexpr std::uint64_t kReserve = 1024;
  bool is_budget_too_small() const { return retries_ > kMaxRetries; }
  /// Returns whether the attempts so far leave no work for another one that would be worth while.
  bool is_effort_spent() const { return work_.left() < kMinAttempt; }
  static constexpr std::uint64_t kMinAttempt = 1 << 10;
  /// Returns the size field. It is the same for all attempts at the same patches.
  /// Input: `gaps` is there with proximity, and null otherwise.
  const SizeField& size_field(const PatchedSurface& on, const TriangulatedPatches& triangulated, const GapSearch* gaps);
  /// Returns null without proximity. The result refers to its arguments.
  std::unique_ptr<const GapSearch> gap_search(const PatchedSurface& on, const TriangulatedPatches& triangulated) const;
  std::optional<SizeField> sizes_without_floor(const PatchedSurface& on, const TriangulatedPatches& triangulated) const;
  std::uint64_t max_made() const;
  void refuse_if_hopeless(double least) const;
  bool is_worth_trying_without_budget() const;

  Goals goals_;
  std::uint64_t budget_;  ///< the number of faces that an attempt with a budget may make
  RunControl& control_;
  WorkBound work_;  ///< a step is a triangle of a complete attempt
  bool are_any_curved_ = false;
  double angle_margin_ = 0;    ///< in degrees
  bool needs_budget_ = false;  ///< an attempt without a budget made too many faces, or would
  bool is_hopeless_ = false;   ///< far more faces than allowed were predicted or made
  int retries_ = 0;
  std::uint64_t last_faces_ = 0;            ///< the faces of the last result that was over its budget; 0: none yet
  IdVector<PatchId, std::uint8_t> frozen_;  ///< one per patch; not 0: it is not refined
  std::optional<SizeField> sizes_;          ///< the size field of the patches as they are; empty until needed
  std::uint64_t predicted_faces_ = 0;
  std::vector<float> predicted_of_patch_;
  std::optional<double> smallest_gap_;
};

}  // namespace remesh
