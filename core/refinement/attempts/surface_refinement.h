/// Refines the patches of a surface in one attempt, as choices say.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/meshing/triangulated_patches.h"
#include "core/refinement/attempts/refinement_choices.h"
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
  /// The pairs of patches that cross or touch each other in the input. The smaller id of a pair comes first, and the
  /// pairs are sorted. There are no gaps between them.
  std::span<const std::pair<PatchId, PatchId>> crossing = {};
};

/// The facts about the curved patches of a surface that refinement has to know.
struct CurvedFacts {
  bool are_any = false;  ///< these have to be refined even if there is no other goal
  /// Most of them are to be finer than the input's facets. So their faces are asked for, and no floor is looked for.
  bool are_finer = false;
  /// Refinement aims at angles that are larger by this many degrees, because vertices are to be moved after it.
  double angle_margin = 0;
};

/// The result of an attempt to refine.
struct RefinementAttempt {
  enum class End : std::uint8_t {
    kRefined,          ///< there is a refinement
    kMinEdgeTooShort,  ///< there would surely be more faces than are in proportion, so nothing was refined
    kGapsTooFine,      ///< gaps ask for so many faces that sizes should be no smaller than `coarsest`
    kTooManyMade       ///< far too many faces were made, or would be
  };
  End end = End::kRefined;
  double coarsest = 0;                     ///< in model units
  Refinement refinement;                   ///< empty unless the attempt has ended with one
  IdVector<PatchId, std::uint8_t> frozen;  ///< one per patch; not 0: it and its boundary had to stay as they were
  /// It is open which triangles miss sizes that vary. If a result has failed the check before, or it has a budget, this
  /// one may fail as well, and to measure sizes takes as long as all the rest. If patches cross each other, vertices
  /// may have to be moved apart first.
  bool are_sizes_unmeasured = false;
  bool may_measure_later = false;  ///< sizes vary, and have to be measured again if vertices are moved apart
  /// Why triangles were left as they are, whatever they miss.
  bool is_by_budget = false, is_by_effort = false, is_cut_short = false;
  std::uint64_t size_steps = 0;  ///< those that the search for gaps took from which sizes were found
  /// The most triangles that should be spent on results that fail the check; empty if no limit is known.
  std::optional<std::uint64_t> max_in_vain;
};

/// The faces that a remeshing has made.
struct MadeFaces {
  std::uint64_t faces;          ///< of all patches
  std::vector<float> of_patch;  ///< for each patch; empty if the patches of the analysis are others
  RefinementChoices choices;    ///< those that have led to the faces
};

/// Refines one division of a surface into patches. The fields of sizes are kept for the next attempt at the same
/// patches. They depend on the choices alone, so an attempt is a function of the patches and of its arguments.
/// This class is larger than the bound because each decision of an attempt has a constant here, with its reason.
class SurfaceRefinement {
 public:
  /// If `goals` sets no goal, nothing is refined but curved patches.
  SurfaceRefinement(const Goals& goals, const CurvedFacts& curved, RunControl& control)
      : asked_(goals), curved_(curved), control_(control) {}

  /// Returns the goals with the floor that was chosen, and with the largest edge that was chosen for the last attempt.
  Goals goals(const RefinementChoices& choices) const;
  /// Returns what is known of the goals and, after an attempt, of what was predicted for it.
  RefinementFacts facts() const;
  bool has_goals(const RefinementChoices& choices) const { return facts().has_goals(choices); }
  /// Returns the number of samples of sizes that are held.
  std::size_t sample_count() const { return sizes_.field ? sizes_.field->sample_count() : 0; }
  /// Returns the smallest distance from a facet to another that is not its neighbour, in model units. It is known only
  /// after an attempt with goals.proximity, and not if the search for it was cut short.
  std::optional<double> smallest_gap() const { return sizes_.smallest_gap; }

  /// Refines the triangles of all patches but the frozen ones.
  /// Input:  `frozen` has one entry per patch. `effort` is what attempts have taken so far.
  /// Errors: kOutputTooLarge - no result with these sizes can have as few faces as are allowed.
  RefinementAttempt refine(const PatchedSurface& on, const RefinementChoices& choices, const Effort& effort,
                           IdVector<PatchId, std::uint8_t> frozen, TriangulatedPatches& triangulated);
  /// Finds the triangles of an attempt that miss sizes, and why.
  /// Input: the arguments of the attempt, and its result; `refined` is the refinement of it. New vertices may have been
  ///        moved since, by less than the plane tolerance.
  void measure_sizes(const PatchedSurface& on, const RefinementChoices& choices, const RefinementAttempt& attempt,
                     Refinement& refined, TriangulatedPatches& triangulated) const;

  /// Predicts how many faces refinement will make of these triangles. If they are out of proportion, it is predicted
  /// for the lowest floor with which they are not, and that floor is chosen.
  /// Input:  `made` has the faces that a remeshing has made, if that is known. Then its choices are taken.
  /// Output: how the faces that are predicted, or made, are shared out among the patches; their sum is that number.
  ///         Empty without goals.
  Prediction predict_before(const PatchedSurface& on, RefinementChoices& choices,
                            const TriangulatedPatches& triangulated, const std::optional<MadeFaces>& made);
  /// Predicts how many faces refinement would make with other goals.
  /// Input: the triangles as they are before refinement; `earlier_steps` are those of all searches for gaps so far.
  /// Cost:  that of a prediction. With other sizes that vary, the size field is computed for them, or rescaled if it
  /// has many samples.
  double predict_with(const Goals& goals, const PatchedSurface& on, std::uint64_t earlier_steps,
                      const TriangulatedPatches& triangulated) const;

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
  static constexpr double kSurelyTooMany = 4, kAsMany = 0.9;
  /// An attempt without a budget is not worth while if more than kHopeless times the faces allowed are predicted. Up to
  /// kFewFaces it is tried in any case, for two reasons: where boundaries are locked or edges must not be short,
  /// predictions may be far too high, and it takes a second at most.
  static constexpr double kHopeless = 2, kFewFaces = 0x1p17;
  /// Gaps are not looked for again to predict faces with other goals if that would take about as long as an attempt.
  static constexpr std::size_t kManySamples = std::size_t{1} << 13;

  /// A largest edge is by this factor longer than the median edge of a surface that is refined with it.
  static constexpr double kLargestOfMedian = 1.5;
  /// Of the faces that are predicted because of the largest edge, this share is made. See experiments.md,
  /// Targets.
  static constexpr double kMadeOfPredicted = 0.77;

  bool is_min_edge_automatic() const;
  void choose_largest_edge(const PatchedSurface& on, const RefinementChoices& choices,
                           const TriangulatedPatches& triangulated);
  std::unique_ptr<const GapSearch> gap_search(const PatchedSurface& on, const TriangulatedPatches& triangulated) const;
  std::optional<SizeField> sizes_without_floor(const PatchedSurface& on, const Goals& goals,
                                               const TriangulatedPatches& triangulated) const;
  void find_smallest_gap(const GapSearch& gaps);
  /// Returns the steps that the search for gaps took; 0 if the field was there.
  std::uint64_t make_size_field(const PatchedSurface& on, const RefinementChoices& choices, std::uint64_t earlier_steps,
                                const TriangulatedPatches& triangulated, const GapSearch* gaps);
  Prediction predict_with_floor(const PatchedSurface& on, RefinementChoices& choices,
                                const TriangulatedPatches& triangulated, const GapSearch* gaps);
  Prediction predict_now(const Goals& goals, bool is_any_refined, const TriangulatedPatches& triangulated);
  bool is_min_edge_surely_too_short(const RefinementChoices& choices) const;
  void limit_to_proportion(Prediction& prediction) const;
  std::uint64_t max_made(const RefinementChoices& choices, const Effort& effort, double predicted) const;
  void refuse_if_hopeless(double least) const;

  /// Holds what is known of sizes, for the patches as they are.
  struct Sizes {
    std::optional<SizeField> without_floor;  ///< with the floor that was asked for; empty until needed
    double coarsest = 0;                     ///< the choice for `without_floor`
    std::optional<SizeField> field;          ///< with the floor and the target of these choices; empty until needed
    double field_floor = 0;                  ///< in model units
    TargetChoice target;
    double aimed_over_target = 1;  ///< see RefinementFacts
    double largest = HUGE_VAL;     ///< the largest edge that was chosen for the target, in model units
    std::optional<double> smallest_gap;
    bool is_smallest_gap_known = false;
    std::optional<Prediction> predicted;  ///< the faces predicted from `field`; empty until needed
  };

  const Goals asked_;
  const CurvedFacts curved_;
  RunControl& control_;
  Sizes sizes_;
  double predicted_ = HUGE_VAL;  ///< for the last attempt, without any limit but the floor
};

}  // namespace remesh
