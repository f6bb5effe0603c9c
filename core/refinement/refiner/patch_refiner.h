/// Refines one patch in its plane for angles and sizes, until there is no more work.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/small_blocks.h"
#include "core/base/work_bound.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patches/charts/patch_chart.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/refinement/refiner/patch_sizes.h"
#include "core/refinement/refiner/patch_thinner.h"
#include "core/refinement/refiner/patch_to_refine.h"
#include "core/refinement/refiner/refiner_scratch.h"
#include "core/refinement/refiner/working_patch.h"
#include "core/refinement/segments/segment_cuts.h"
#include "core/refinement/sizes/criteria.h"

namespace remesh {

class PatchEditor;

/// Derives the progress from the number of triangles and the predicted number. There may be twice as many as predicted;
/// then the progress stands at 95 %. All members may be called from any thread.
class RefinementProgress {
 public:
  RefinementProgress(RunControl& control, double expected) : control_(control), expected_(std::max(expected, 1.0)) {}

  /// Must be called when a refinement begins, or begins again, with this number of triangles.
  void begin(std::uint64_t faces) { faces_ = static_cast<std::int64_t>(faces); }
  /// Must be called when there are this many more (or fewer) triangles. It is also a point of cancellation.
  void add(std::int64_t faces) {
    const double fraction = static_cast<double>(faces_ += faces) / expected_;
    // The progress never goes back, even if the refinement begins again.
    double known = fraction_;
    while (known < fraction && !fraction_.compare_exchange_weak(known, fraction)) {
    }
    control_.progress(std::min(0.95, std::max(known, fraction)));
  }

  void check() const { control_.check(); }

 private:
  RunControl& control_;
  const double expected_;
  std::atomic<std::int64_t> faces_{0};
  std::atomic<double> fraction_{0};
};

/// A patch while it is refined. It cuts its own segments at once, at the places that the segment table gives, and
/// stores these cuts. Between rounds it applies the cuts that other patches made. Between its turns it stores the
/// patch, and no scratch memory. The work is done by classes that live as long as one call: PatchStart begins it,
/// TriangleTreatment mends triangles, PatchEditor makes the changes, and PatchThinner removes points in the end.
class PatchRefiner {
 public:
  /// `cuts` has the cuts of every segment, ascending. The cuts of the patch's segments are made at once. Where there
  /// are sizes, wide areas are filled evenly with at most about `quota` triangles. The constructor also begins the
  /// first turn, with `scratch`.
  PatchRefiner(const PatchToRefine& patch, const Criteria& criteria, const SegmentCuts::OfSegments& cuts,
               std::uint64_t quota, RefinerScratch& scratch, RunControl& control);

  /// The patch may only be changed between these two calls, in its turn. No other refiner may use the scratch memory
  /// during the turn.
  void begin_turn(RefinerScratch& scratch);
  void end_turn();

  /// Returns whether refinement would change the patch at all. The test is cheap and needs no refiner.
  static bool has_work(const PatchMesh& patch, const PatchChart& chart, const Criteria& criteria);

  /// Cuts the patch's sides along `segment` wherever they are not cut yet. `cuts` are all cuts of that segment,
  /// ascending.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  void apply_cuts(SegmentId segment, std::span<const double> cuts, const RunControl& control);

  /// Puts a point into the middle of each of these edges inside the patch. An edge is left out if it no longer exists
  /// when its turn comes, or if it has no room for a point.
  /// Input:  Half-edges of the mesh that `finish` would return now.
  /// Output: True if a point was put into any of them.
  bool split_edges(std::span<const std::uint32_t> half_edges, RunControl& control);

  /// Lets the patch take this number of steps above the bound on its work (kWorkOfPatch) in this turn. After these, the
  /// turn ends. With 0, or without a call, the patch gives up above its bound: the triangles in the queue stay as they
  /// are, with the reason kEffort.
  void allow_above_bound(std::uint64_t steps);
  /// Returns how many steps above the bound were taken since the last call.
  std::uint64_t take_above_bound() { return above_bound_ - std::exchange(above_bound_told_, above_bound_); }

  /// Works until there is no more work, until `quota` more triangles (in all patches) would be made, or until the
  /// turn's steps are spent.
  void run(std::uint64_t quota, RefinementProgress& progress);

  /// Where there are sizes, removes points from a patch that is done, as PatchThinner says. Candidates are the points
  /// that refinement has inserted or, where sizes vary, all points inside.
  void thin_out(Thinning thinning, RunControl& control, RefinementProgress& progress);

  /// Returns a segment that had to be cut where rounding left no room for the cut. Then the patch can no longer be
  /// used, and the segment must stay as it is for all patches. If there was no such segment, the result is invalid.
  SegmentId impossible() const { return patch_.impossible; }
  bool is_done() const { return patch_.waiting.size() == 0; }
  /// Returns whether the turn has ended because its steps are spent.
  bool is_turn_spent() const { return is_turn_spent_; }
  std::size_t waiting() const { return patch_.waiting.size(); }
  std::uint32_t triangle_count() const { return patch_.mesh.triangle_count(); }
  /// Appends the cuts made here since the last call.
  void take_own_cuts(std::vector<Cut>& cuts) {
    cuts.insert(cuts.end(), patch_.own_cuts.begin(), patch_.own_cuts.end());
    patch_.own_cuts.clear();
  }

  struct Refined {
    PatchMesh patch;  ///< new vertices have no id yet
    /// One entry per vertex of the patch. Its segment is invalid for a corner and for a vertex inside the patch.
    std::vector<Cut> cuts;
    /// One entry per triangle: the reason why the triangle misses a bound, in case it does.
    std::vector<UnrefinedReason> reason;
  };
  Refined finish() const;

 private:
  void fill_columns(PatchEditor& editor, std::uint64_t quota, RunControl& control);
  bool is_near_boundary(const PointPlace& place, double spacing) const;
  static std::size_t first_block(const PatchMesh& patch, std::size_t sides);
  UnrefinedReason reason_of(std::uint32_t t) const;
  void take(std::uint64_t steps);
  void give_up();

  const PatchMesh& original_;
  SmallBlocks memory_;
  const PatchSizes sizes_;
  RefinerScratch* scratch_;  ///< only during a turn
  WorkingPatch patch_;
  WorkBound work_;  ///< the steps of all turns
  /// The steps above the bound: those taken, those reported by take_above_bound, and those after which the turn ends.
  std::uint64_t above_bound_ = 0, above_bound_told_ = 0, allowed_above_bound_ = 0;
  bool is_turn_spent_ = false;
  std::uint32_t first_refined_;  ///< the number of vertices when refinement began
};

}  // namespace remesh
