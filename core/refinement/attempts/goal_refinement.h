/// Runs refinement: it makes attempts within a budget, and freezes patches whose refinement fails.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/patches/planar/ladder.h"
#include "core/refinement/attempts/attempt_effort.h"
#include "core/refinement/attempts/floor_search.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/prediction/prediction.h"
#include "core/refinement/rounds/rounds.h"
#include "core/refinement/sizes/gap_search.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// Refinement gets a surface that is divided into patches.
struct PatchedSurface {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  double plane_tolerance;  ///< model units
};

/// Refines one surface in one or more attempts, and remembers what the attempts so far have shown.
/// This class is larger than the bound because each decision about attempts has a constant here, with its reason.
class GoalRefinement {
 public:
  /// If `goals` sets no goal, nothing is refined.
  /// Input: `taken` is the work that attempts at the surface took before its faces were mended anew, and `floor` is the
  ///        goals' min_edge_length that they have found.
  GoalRefinement(const Goals& goals, RunControl& control, const AttemptEffort::Taken& taken = {}, double floor = 0)
      : goals_(goals),
        budget_(goals.max_faces),
        control_(control),
        asked_floor_(goals.min_edge_length),
        floors_(goals, floor),
        effort_(expected_limit(), taken) {
    if (budget_ != Goals::kNoLimit) budget_ -= budget_ / kReserve;
    goals_.min_edge_length = floors_.floor();
  }

  const Goals& goals() const { return goals_; }
  bool has_goals() const;
  /// Returns the work that all attempts so far have taken.
  AttemptEffort::Taken work_taken() const { return effort_.all_taken(); }
  /// Takes the steps of the search for intersections in the check of a result.
  void take_check(std::uint64_t steps) { effort_.take_check(steps); }
  /// Tells whether some patches are curved. These have to be refined even if there is no other goal. If most of them
  /// are to be finer than the input's facets, their faces are asked for, and no floor is looked for.
  void set_curved(bool are_any_curved, bool are_finer) {
    are_any_curved_ = are_any_curved;
    are_finer_ = are_finer;
    effort_.set_max_faces(expected_limit());
  }
  /// Tells which pairs of patches cross or touch each other in the input. The smaller id of a pair comes first, and the
  /// pairs are sorted. There are no gaps between them.
  void set_crossing(std::span<const std::pair<PatchId, PatchId>> crossing) {
    crossing_.assign(crossing.begin(), crossing.end());
  }
  /// Makes refinement aim at larger angles than are asked for, by some degrees. Vertices are to be moved after it.
  void set_angle_margin(double degrees) { angle_margin_ = degrees; }
  /// Returns the number of faces that predict_before predicted.
  std::uint64_t predicted_faces() const { return static_cast<std::uint64_t>(std::min(predicted_.expected, 0x1p62)); }
  /// Returns whether edges must not be shorter than a floor that was found, and that another attempt may raise.
  bool has_found_floor() const { return goals_.min_edge_length > asked_floor_ && may_change_floor(); }
  /// Returns the smallest distance from a facet to another that is not its neighbour, in model units. It is known only
  /// with goals.proximity, and not if the search for it was cut short.
  std::optional<double> smallest_gap() const { return sizes_.smallest_gap; }

  /// Returns the number of samples of sizes that are held.
  std::size_t sample_count() const { return sizes_.field ? sizes_.field->sample_count() : 0; }

  /// Predicts closely how many faces refinement will make of these triangles. If they are out of proportion, it is
  /// predicted for the lowest floor with which they are not.
  void predict_before(const PatchedSurface& on, const TriangulatedPatches& triangulated);
  /// Returns how the faces that predict_before predicted are shared out among the patches. Their sum is that number.
  /// Empty without goals.
  const std::vector<float>& predicted_of_patch() const { return predicted_.of_patch; }

  /// Predicts roughly how many faces refinement would make with other goals.
  /// Input: the triangles as they are before refinement.
  /// Cost:  that of a prediction. With other sizes that vary, the size field is computed for them, or rescaled if it
  /// has many samples.
  double predict_with(const Goals& goals, const PatchedSurface& on, const TriangulatedPatches& triangulated) const;

  /// Refines the triangles of all patches, except patches that the ladder takes verbatim and frozen patches.
  /// Input:  `crossing` lists the pairs of patches that cross or touch each other in the input. The smaller id of a
  ///         pair comes first, and the pairs are sorted.
  /// Errors: kOutputTooLarge - no result with these sizes can have as few faces as are allowed.
  Refinement refine(const PatchedSurface& on, const Ladder& ladder,
                    std::span<const std::pair<PatchId, PatchId>> crossing, TriangulatedPatches& triangulated);
  /// Returns whether the last refinement has left it open which triangles miss sizes that vary. If a result has failed
  /// the check before, or it has a budget, this one may fail as well, and to measure sizes takes as long as all the
  /// rest. If patches cross each other, vertices may have to be moved apart first.
  bool are_sizes_unmeasured() const { return are_sizes_unmeasured_; }
  /// Tells that vertices of the last refinement were moved apart and edges flipped, so that sizes have to be measured
  /// again. Nothing is measured again if vertices are moved to keep a volume, since that comes before.
  void note_separated_vertices() { are_sizes_unmeasured_ = may_measure_later_; }
  /// Finds the triangles of the last refinement that miss sizes, and why.
  /// Input: the arguments of that refinement, and its result. New vertices may have been moved since, by less than the
  ///        plane tolerance.
  void measure_sizes(const PatchedSurface& on, TriangulatedPatches& triangulated, Refinement& refined) const;
  /// Has one entry per patch, which is not 0 if the last refinement had to leave the patch and its boundary as they
  /// were.
  const IdVector<PatchId, std::uint8_t>& frozen() const { return frozen_; }

  /// Returns whether a result with so many faces needs another attempt, and adapts the budget for that attempt. Or it
  /// adapts the floor under the lengths of edges, if the faces are out of proportion (Goals::faces_without_floor), if
  /// the floor leaves worse angles than there were before, or if a lower floor may serve as well. The first attempt has
  /// no budget as long as it does not make far more triangles than allowed: many of them are removed when patches are
  /// thinned out, so they are no reason to leave anything undone.
  /// The next attempt may exceed its budget by cuts that patches have to make because their neighbours made them, by
  /// points in chords, or by cuts for sizes alone. Then the attempt after it gets a smaller budget. If that does not
  /// help, or not soon enough, nothing is refined.
  bool is_over_budget(std::uint64_t faces, bool are_angles_worse);

  /// Freezes patches whose refinement failed the check: they stay as they were before it. Returns whether any of them
  /// was not frozen before.
  /// Input: `count` is the number of all patches.
  bool freeze(const std::vector<PatchId>& failed, std::size_t count);
  /// Must be called before each attempt. Curved patches have to be refined, or they fail.
  void begin_attempt() { effort_.begin_attempt(!are_any_curved_); }
  /// Returns whether the attempt that has just passed the check had no goals because too much work was in vain. Then
  /// the next one has them again, and patches that have ever failed must be frozen for it.
  bool goes_on_with_the_rest();
  /// Returns whether the next attempt has to leave all patches as they are, after which a result passed before.
  bool gives_up_the_rest() { return effort_.gives_up_the_rest(); }
  /// Forgets what is known of the patches. After a step of the ladder the patches are others.
  void thaw() {
    effort_.note_other_patches();
    forget_patches();
  }
  /// Forgets the last attempt, whose only fault was the number of its faces, and what is known of its patches.
  void forget_attempt() {
    effort_.give_back_last();
    forget_patches();
  }
  /// Forgets what is known of the patches because others are made. The last attempt was not wrong.
  void forget_patches() {
    sizes_.is_smallest_gap_known = false;
    frozen_.clear();
    sizes_.without_floor.reset();
    sizes_.field.reset();
    sizes_.predicted.reset();
    crossing_.clear();
    last_faces_ = 0;
  }

 private:
  /// An attempt without a budget ends when it makes far more faces than are allowed: kMaxMade times as many, if that is
  /// no more than kFewMore faces above the limit, and otherwise kMaxManyMade times as many. It ends in any case with
  /// kMaxMadeBeyond above the limit, which would take a few GB of memory. See experiments.md, Prediction.
  static constexpr double kMaxMade = 4, kMaxManyMade = 1.5, kFewMore = 0x1p17, kMaxMadeBeyond = 0x1p23;
  /// It also ends when it makes more faces than allowed and kMaxOfPredicted times those that are predicted. Thinning
  /// out leaves a third at least, so the prediction was far too low, and nothing tells that there is an end at all.
  static constexpr double kMaxOfPredicted = 4;
  /// If gaps ask for kFarTooMany times the faces allowed, most of what they ask for cannot be met. Then no size is
  /// below the edge of kEvenShare times the faces allowed, evenly spread over the surface. This is because work that
  /// depends on sizes would be for far more faces than there will be.
  static constexpr double kFarTooMany = 8, kEvenShare = 2;
  /// Where sizes vary, a floor is too low without an attempt if kSurelyTooMany times the faces in proportion are
  /// predicted with it, or if no fewer than kAsMany of what was predicted with a floor that was too low.
  static constexpr double kSurelyTooMany = 3, kAsMany = 0.9;
  /// An attempt without a budget is not worth while if more than kHopeless times the faces allowed are predicted. Up to
  /// kFewFaces it is tried in any case, for two reasons: where boundaries are locked or edges must not be short,
  /// predictions may be far too high, and it takes a second at most.
  static constexpr double kHopeless = 2, kFewFaces = 0x1p17;
  /// Gaps are not looked for again to predict faces with other goals if that would take about as long as an attempt.
  static constexpr std::size_t kManySamples = std::size_t{1} << 13;
  static constexpr int kMaxRetries = 6;
  static constexpr int kRetriesInVain = 3;  ///< a retry that made no fewer faces counts as so many
  /// One kReserve-th of the faces allowed is reserved for what comes when the budget is spent: cuts that neighbours
  /// made, and points in chords. Without it, the result might exceed the limit, and another attempt would take as long
  /// as the first.
  static constexpr std::uint64_t kReserve = 1024;
  bool is_budget_too_small() const { return retries_ > kMaxRetries; }
  /// Returns how many faces the result has at most, for the bound on the work of attempts.
  std::uint64_t expected_limit() const { return is_floor_automatic() ? goals_.faces_without_floor : goals_.max_faces; }
  /// Returns the size field. It is the same for all attempts at the same patches.
  /// Input: `gaps` is there with proximity, and null otherwise.
  const SizeField& size_field(const PatchedSurface& on, const TriangulatedPatches& triangulated, const GapSearch* gaps);
  /// Returns null without proximity. The result refers to its arguments.
  std::unique_ptr<const GapSearch> gap_search(const PatchedSurface& on, const TriangulatedPatches& triangulated) const;
  std::optional<SizeField> sizes_without_floor(const PatchedSurface& on, const TriangulatedPatches& triangulated) const;
  void find_smallest_gap(const GapSearch& gaps);
  /// Predicts roughly how many faces this refinement makes, if that is not known yet.
  /// Input: if any patch is refined, the size field must be there. Otherwise all triangles stay.
  Prediction predict_now(const TriangulatedPatches& triangulated, bool is_any_refined);
  Prediction predict_attempt(const PatchedSurface& on, const TriangulatedPatches& triangulated, const GapSearch* gaps,
                             bool is_any_refined);
  std::uint64_t max_made() const;
  bool is_floor_automatic() const;
  bool may_change_floor() const;
  void change_floor();
  bool needs_other_floor(std::uint64_t faces, bool are_angles_worse);
  void limit_to_proportion(Prediction& prediction) const;
  void refuse_if_hopeless(double least) const;
  bool is_worth_trying_without_budget() const;

  /// Holds what is known of sizes, for the patches as they are.
  struct Sizes {
    std::optional<SizeField> without_floor;  ///< with the floor that was asked for; empty until needed
    std::optional<SizeField> field;          ///< with the floor in force; empty until needed
    double field_floor = 0;                  ///< the floor in force for `field`, in model units
    double coarsest = 0;                     ///< gaps do not make sizes smaller than this, in model units
    std::optional<double> smallest_gap;
    bool is_smallest_gap_known = false;
    std::optional<Prediction> predicted;  ///< what the field lets expect, with this floor; empty until needed
    double predicted_floor = 0;
  };

  /// Holds why triangles of an attempt were left as they are, whatever they miss.
  struct Overridden {
    bool by_budget = false, by_effort = false, is_cut_short = false;
    void write_to(std::vector<UnrefinedReason>& reasons) const;
  };

  Goals goals_;
  std::uint64_t budget_;  ///< the number of faces that an attempt with a budget may make
  RunControl& control_;
  bool are_any_curved_ = false, are_finer_ = false;
  double too_many_predicted_ = HUGE_VAL;    ///< roughly, with the last floor that an attempt has shown to be too low
  double unlimited_prediction_ = HUGE_VAL;  ///< roughly, for the present attempt
  double asked_floor_;                      ///< min_edge_length of the goals, before a floor was found
  std::vector<std::pair<PatchId, PatchId>> crossing_;
  FloorSearch floors_;
  AttemptEffort effort_;
  Overridden overridden_;              ///< is about the last attempt
  bool may_measure_later_ = false;     ///< sizes vary, and those of the last attempt may be measured in the check
  bool are_sizes_unmeasured_ = false;  ///< those of the last attempt have yet to be measured
  double angle_margin_ = 0;            ///< in degrees
  bool needs_budget_ = false;          ///< an attempt without a budget made too many faces, or would
  /// Far more faces than allowed were predicted or made. Or more were made where many are allowed.
  bool is_hopeless_ = false;
  int retries_ = 0;
  std::uint64_t last_faces_ = 0;            ///< the faces of the last result that was over its budget; 0: none yet
  IdVector<PatchId, std::uint8_t> frozen_;  ///< one per patch; not 0: it is not refined
  Sizes sizes_;
  std::uint64_t roughly_predicted_ = 0;  ///< by the last attempt, before it began
  Prediction predicted_;                 ///< what users are told
};

}  // namespace remesh
