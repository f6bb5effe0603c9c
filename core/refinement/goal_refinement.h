/// Refinement as a run uses it: from options to goals, within a budget, patch by patch where one fails.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/ladder.h"
#include "core/refinement/gap_search.h"
#include "core/refinement/goals.h"
#include "core/refinement/rounds.h"
#include "core/refinement/size_field.h"

namespace remesh {

/// What is refined.
struct PatchedSurface {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  double plane_tolerance;  ///< model units
};

/// What attempts at one surface have shown so far.
class GoalRefinement {
 public:
  /// Without goals nothing is refined.
  GoalRefinement(const Goals& goals, RunControl& control) : goals_(goals), budget_(goals.max_faces), control_(control) {
    if (budget_ != std::numeric_limits<std::uint64_t>::max()) budget_ -= budget_ / kReserve;
  }

  const Goals& goals() const { return goals_; }
  bool has_goals() const;
  /// Faces, as predicted by the last attempt.
  std::uint64_t predicted_faces() const { return predicted_faces_; }
  /// To the nearest facet that is not a neighbour, model units; known with goals.proximity.
  std::optional<double> smallest_gap() const { return smallest_gap_; }

  /// How many faces refinement would make of these triangles.
  std::uint64_t predict_faces(const PatchedSurface& on, const std::vector<PatchMesh>& meshes);

  /// Refines the patches' triangles; those that the ladder keeps, and those frozen, stay.
  /// Input:  `crossing`: pairs of patches that cross or touch each other in the input, the smaller one first, sorted.
  /// Errors: kOutputTooLarge - no result with these sizes can have as few faces as are allowed.
  Refinement refine(const PatchedSurface& on, const Ladder& ladder,
                    std::span<const std::pair<PatchId, PatchId>> crossing, std::vector<PatchMesh>& meshes);
  /// Of each patch, whether the last refinement had to leave it and its boundary as they were.
  const std::vector<std::uint8_t>& frozen() const { return frozen_; }

  /// Whether a result of so many faces is more than the budget. The first attempt has none, as long as there are not
  /// far more triangles than allowed: what is made and thinned out in the end is no reason to leave anything undone.
  /// The next one may overshoot its budget by what patches do for each other at the end, or do for sizes alone: then
  /// the one after gets less, and where that does not help, or not soon, nothing is refined.
  bool is_over_budget(std::uint64_t faces);

  /// Patches whose refinement failed the check stay as they were before it. Output: whether that is a change.
  bool freeze(const std::vector<PatchId>& failed);
  /// After a step of the ladder the patches are others.
  void thaw() {
    frozen_.clear();
    sizes_.reset();
    last_faces_ = 0;
  }

 private:
  /// An attempt without a budget may make so many times the faces allowed, though no more beyond these than would take
  /// a few GB. (A slot behind which sizes grow, at 33 degrees, has three times as many before it is thinned out.)
  static constexpr std::uint64_t kMaxMade = 4, kMaxMadeBeyond = std::uint64_t{1} << 23;
  /// It is not worth it where that many times the faces allowed are predicted, or so many if these are few: where
  /// boundaries are locked or edges must not be short, predictions may be far too high, and it takes a second at most.
  static constexpr double kHopeless = 2, kFewFaces = 0x1p17;
  static constexpr int kMaxRetries = 6;
  static constexpr int kRetriesInVain = 3;  ///< so many does one count for that made no fewer faces
  /// One part in so many of the faces allowed is kept for what patches do for each other at the end: another attempt
  /// would take as long as the first.
  static constexpr std::uint64_t kReserve = 1024;
  bool is_budget_too_small() const { return retries_ > kMaxRetries; }
  /// The same for all attempts at the same patches.
  /// Input:  with proximity, the gaps.
  const SizeField& size_field(const PatchedSurface& on, const std::vector<PatchMesh>& meshes, const GapSearch* gaps);
  /// With proximity. It refers to what it is built on.
  std::unique_ptr<const GapSearch> gap_search(const PatchedSurface& on, const std::vector<PatchMesh>& meshes) const;
  std::optional<SizeField> sizes_without_floor(const PatchedSurface& on, const std::vector<PatchMesh>& meshes) const;
  void refuse_if_hopeless(double least) const;
  bool is_worth_trying_without_budget() const;

  Goals goals_;
  std::uint64_t budget_;  ///< faces that refinement may make it
  RunControl& control_;
  bool needs_budget_ = false;  ///< an attempt without it made too many faces, or would
  int retries_ = 0;
  std::uint64_t last_faces_ = 0;      ///< that were too many; 0: none yet
  std::vector<std::uint8_t> frozen_;  ///< per patch: not refined
  std::optional<SizeField> sizes_;    ///< of the patches as they are, if it has been asked for
  std::uint64_t predicted_faces_ = 0;
  std::optional<double> smallest_gap_;
};

}  // namespace remesh
