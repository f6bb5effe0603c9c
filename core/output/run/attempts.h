/// Makes attempts at a surface, as decisions say.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/output/result/result.h"
#include "core/output/run/decisions.h"
#include "core/output/run/outcome.h"
#include "core/output/run/run_products.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/planar/coplanar_regions.h"
#include "core/refinement/adjustment/separation.h"

namespace remesh {

/// Runs the steps of the pipeline. The outcome of an attempt is a function of the input, the options, the decisions and
/// the effort so far. The product of a step is used again as long as the decisions that the step reads are the same.
/// This class is larger than the bound because it has a short function for each step of the pipeline, so that the whole
/// can be read in one place.
class Attempts {
 public:
  /// Input: `storage` tells for which numbers the result is meant. `diagnostics` are those of the reader.
  Attempts(const PolygonMesh& input, const Options& options, Storage storage, std::vector<Diagnostic> diagnostics,
           RunControl& control);

  /// Mends the input, and returns the decisions for the first attempt.
  Decisions first_decisions();
  /// Makes an attempt at a result.
  /// Errors: kOutputTooLarge - no result can have as few faces as are allowed; kCancelled, kTimeout - asked to stop.
  Outcome attempt(const Decisions& decisions, const Effort& effort);
  /// Divides the surface into patches, and triangulates these, without trying to make a result.
  /// Output: kSurfaceReplaced, or kVerified if the patches are there.
  Outcome divide(const Decisions& decisions);

  /// Returns the error for an attempt after which nothing is left to be tried.
  Error failure(const Outcome& outcome) const;
  /// Moves out what the last attempt has made.
  std::unique_ptr<RunProducts> take_products() { return std::move(products_); }

 private:
  /// The part of the decisions that the division into patches reads.
  struct Division {
    FaceRungs rungs;
    CurvedChoices curved;
    bool operator==(const Division&) const = default;
  };

  const Surface& surface() const { return products_->surface(); }
  const PatchSet& patches() const { return products_->partition.patches; }
  RunControl& control() const { return products_->control; }
  const Options& options() const { return products_->options; }

  void prepare(const MendingLimits& mending);
  Goals goals_in_proportion() const;
  double step_of_storage() const;
  void forget_surface();
  void make_surface(const Decisions& decisions);
  std::optional<Outcome::End> make_patches(const Decisions& decisions, Outcome& outcome);
  void divide_by(const FaceRungs& rungs);
  bool arrange_faces();
  bool remove_details(const FaceMarks& kept);
  void replace_surface(Replaced&& replaced);
  bool may_become_coarser(const Decisions& decisions) const;
  bool coarsen_surface();
  void recognise(const FaceRungs& rungs, const PatchSet& before);
  void join(const CurvedChoices& choices);
  void triangulate();
  void count_output();
  void report_failed(const std::vector<FailedPatch>& failed, Outcome& outcome);
  Outcome::End make_result(const Decisions& decisions, const Effort& effort, Outcome& outcome);
  std::optional<Outcome::End> refine(const RefinementChoices& choices, const Effort& effort, Outcome& outcome);
  IdVector<PatchId, std::uint8_t> frozen_patches(const FaceMarks& frozen);
  void separate_chords();
  void lift();
  std::vector<std::uint64_t> triangles_of_patches() const;
  std::optional<Outcome::End> keep_volumes(const CurvedChoices& choices, Outcome& outcome);
  void refuse_if_too_large() const;
  void check_candidate(const RefinementChoices& choices, Outcome& outcome);
  bool separate_vertices(TwinsOf of);
  Outcome::End report_check(Outcome& outcome);

  std::unique_ptr<RunProducts> products_;
  const std::vector<Diagnostic> diagnostics_of_reader_;
  const Storage storage_;
  CurvedGoals curved_goals_;  ///< known when the prepared surface is
  Goals goals_;               ///< those that are asked for
  // The products were made for these decisions.
  std::optional<MendingLimits> prepared_for_;
  std::optional<FaceRungs> arranged_for_;
  std::vector<FaceRungs> replaced_for_;
  std::optional<Division> divided_for_;
  // The following is needed to divide the surface again.
  Regions regions_;  ///< those on no rung
  bool is_recognised_ = false;
  SurfaceRungs rungs_;
  RefinementAttempt refined_;  ///< the last refinement, which is in the candidate
};

}  // namespace remesh
