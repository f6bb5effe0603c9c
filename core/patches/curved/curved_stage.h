/// Recognises curved surfaces and remeshes them as a whole, as far as that is asked for and succeeds.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mending/preparation.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/chains/curve_cuts.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/coarser_facets.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/curved/volume_offsets.h"
#include "core/patches/meshing/partition.h"
#include "core/patches/meshing/patch_meshing.h"
#include "core/patches/planar/ladder.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Knows what the facets of a prepared surface were made from, and which of them are joined into curved patches. It
/// remembers between attempts which curved patches have failed.
class CurvedStage {
 public:
  /// The measures of a run. Lengths are in model units.
  struct Measures {
    double plane_tolerance = 0;
    double min_angle_deg = 0;  ///< the bound on angles; 0 without refinement
    /// No more faces than these are in proportion to the input (Goals::faces_without_floor).
    std::uint64_t in_proportion = std::numeric_limits<std::uint64_t>::max();
  };

  /// Forgets everything. The next surface is another one.
  void reset() { *this = {}; }
  /// Forgets which facets are joined, and the cuts of their boundaries, as before run() is called. The surfaces are
  /// still known, and so is what has failed.
  void forget_joined();

  /// Takes the patches of the last partition, before any were joined, out of this object or out of the partition.
  PatchSet take_facets(Partition& partition);

  /// Recognises surfaces, or takes over what was recognised of the facets before. Then joins facets, and cuts the
  /// boundaries of the patches that come of that.
  /// Input:   a partition into facets, and the facets of the partition before it, if there was one.
  /// Output:  a partition whose patches may be curved.
  /// Errors:  kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:    O(n log n).
  void run(Partition& partition, const PatchSet& facets_before, Prepared& prepared, Ladder& ladder,
           const Options& options, const CurvedGoals& goals, const Measures& measures, RunControl& control);

  /// Returns the curved patches among the failed ones, and those beside a failed planar patch, which may be at fault.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  std::vector<PatchId> at_fault(const std::vector<FailedPatch>& failed, const PatchSet& patches, const Surface& surface,
                                const Adjacency& adjacency, const RunControl& control) const;
  /// Takes curved patches a rung up: first they get finer limits, and then they become facets again. If their surfaces
  /// are moved outwards, finer limits come first, then the surfaces stay where they are, and then all begins anew. A
  /// chain of neighbours that fail one after the other must not cost a step for each of them. So after some steps,
  /// patches become facets at once, and after some more, all curved patches do.
  /// Input: whether finer limits are worth an attempt.
  void step_up(const std::vector<PatchId>& at_fault, const PatchSet& patches, bool is_patient);

  /// Leaves the facets of those surfaces that would probably be finer if they were joined than if they stay, and joins
  /// those again that have turned out to be finer as facets. All is joined anew then. A surface is left once at most.
  /// Input:   the number of triangles that each patch has, after refinement.
  /// Output:  whether anything has changed.
  bool leave_coarser_facets(const std::vector<std::uint64_t>& triangles, const PatchSet& patches,
                            const CurvedGoals& goals);

  /// Returns the curved patches of some surfaces.
  std::vector<PatchId> patches_of(const std::vector<SurfaceId>& surfaces) const;

  /// Returns the patches that are curved, or null if none is.
  const CurvedPatches* curved() const { return curved_.has_any() ? &curved_ : nullptr; }
  /// Returns the curved patches and the cuts of their boundaries, or nothing if no patch is curved.
  std::optional<CurvedBoundaries> boundaries() const;
  /// Returns the surface with the new vertices of the cuts behind its own.
  const Surface& with_cuts(const Surface& surface) const { return with_cuts_ ? *with_cuts_ : surface; }
  /// Returns the patches before facets were joined.
  const PatchSet& facets(const Partition& partition) const { return curved_.has_any() ? facets_ : partition.patches; }
  /// Returns the new cuts of boundaries; there are none if no patch is curved.
  const CurveCuts& cuts() const { return cuts_; }
  /// Returns by how much curved surfaces are moved outwards, or null if none is.
  VolumeOffsets* outside() { return is_outside_ ? &outside_ : nullptr; }
  const VolumeOffsets* outside() const { return is_outside_ ? &outside_ : nullptr; }
  /// Returns the share of the area of the curved patches that is asked to have more elements per circle than its facets
  /// have.
  double finer_share(const CurvedGoals& goals) const;
  /// Returns the surfaces of the facets.
  const RecognisedSurfaces& recognised() const { return recognised_; }
  /// Takes out the surfaces of the patches that the last run found, with the tolerances in force.
  RecognisedSurfaces take_surfaces() { return std::move(surfaces_); }

 private:
  void recognise(const Partition& partition, Prepared& prepared, const Options& options, double plane_tolerance,
                 RunControl& control);
  void leave_room_for_boundaries();
  void tell_failures(Partition& partition) const;
  void cut_boundaries(Partition& partition, Prepared& prepared, Ladder& ladder, const CurvedGoals& goals,
                      double min_angle_deg, RunControl& control);

  RecognisedSurfaces recognised_;       ///< those of the facets
  RecognisedSurfaces surfaces_;         ///< those of the patches, until they are taken
  IdVector<FaceId, CurvedRung> rungs_;  ///< empty while no curved patch has failed
  int steps_ = 0;                       ///< how often curved patches have been taken a rung up
  int leavings_ = 0;                    ///< how often facets were left because they are coarser
  CurvedPatches curved_;
  CoarserFacets coarser_;             ///< only with curved patches
  CurveCuts cuts_;                    ///< only with curved patches
  std::optional<Surface> with_cuts_;  ///< only with curved patches
  PatchSet facets_;                   ///< only with curved patches
  VolumeOffsets outside_;
  bool is_outside_ = false;  ///< some surfaces are moved outwards
};

}  // namespace remesh
