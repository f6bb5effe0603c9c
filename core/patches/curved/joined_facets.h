/// Recognises curved surfaces, and joins their facets into curved patches, as far as that is asked for and was chosen.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mending/preparation.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/chains/curve_cuts.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/coarser_facets.h"
#include "core/patches/curved/curved_choices.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/curved/volume_offsets.h"
#include "core/patches/meshing/partition.h"
#include "core/patches/meshing/patch_meshing.h"
#include "core/patches/planar/face_rungs.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// The measures of a run. Lengths are in model units.
struct JoiningMeasures {
  double plane_tolerance = 0;
  double min_angle_deg = 0;  ///< the bound on angles; 0 without refinement
  /// No more faces than these are in proportion to the input (Goals::faces_without_min_edge).
  std::uint64_t in_proportion = std::numeric_limits<std::uint64_t>::max();
};

/// Finds what the facets of a surface were made from.
/// Input:  a partition in which no patch stands on a rung.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
RecognisedSurfaces recognise_facets(const Partition& partition, Prepared& prepared, const Options& options,
                                    double plane_tolerance, RunControl& control);

/// The patches of a surface after facets were joined.
struct JoinedFacets {
  RecognisedSurfaces surfaces;  ///< those of the patches, with the tolerances in force
  // The following are empty if no patch is curved.
  CurvedPatches patches;
  CoarserFacets costs;
  CurveCuts cuts;
  std::optional<Surface> with_cuts;      ///< the surface with the new vertices of the cuts behind its own
  PatchSet facets;                       ///< the patches before they were joined
  std::optional<VolumeOffsets> outside;  ///< only if some surfaces are moved outwards

  /// Returns the patches that are curved, or null if none is.
  const CurvedPatches* curved() const { return patches.has_any() ? &patches : nullptr; }
  /// Returns the curved patches and the cuts of their boundaries, or nothing if no patch is curved.
  std::optional<CurvedBoundaries> boundaries() const;
  /// Returns the share of the area of the curved patches that is asked to have more elements per circle than its facets
  /// have.
  double finer_share(const CurvedGoals& goals) const;
  /// Returns the curved patches among the failed ones, and those beside a failed planar patch, which may be at fault.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  std::vector<CurvedFault> faults(const std::vector<FailedPatch>& failed, const PatchSet& patches,
                                  const Surface& surface, const Adjacency& adjacency, const RunControl& control) const;
  /// Returns the curved patches of some surfaces.
  std::vector<CurvedFault> faults_of(std::span<const SurfaceId> surfaces, const PatchSet& patches,
                                     const Surface& surface) const;
  /// Finds facets that would probably be finer if they were joined than if they stay, and facets that were left for
  /// that reason and have turned out to be finer. A surface is left once at most.
  /// Input: the number of triangles that each patch has, after refinement; the surfaces of the patches.
  CoarserFaces compare(const std::vector<std::uint64_t>& triangles, const PatchSet& patches, const Surface& surface,
                       const IdVector<PatchId, SurfaceId>& of_patch, const CurvedChoices& choices,
                       const CurvedGoals& goals) const;

 private:
  std::vector<CurvedFault> faults_at(std::span<const PatchId> curved, const PatchSet& patches,
                                     const Surface& surface) const;
};

/// Joins facets, and cuts the boundaries of the patches that come of that.
/// Input:   a partition into facets, what these were recognised as, and what was chosen for the input faces.
/// Output:  a partition whose patches may be curved.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
JoinedFacets join_facets(Partition& partition, Prepared& prepared, const RecognisedSurfaces& recognised,
                         const SurfaceRungs& rungs, const CurvedChoices& choices, const CurvedGoals& goals,
                         const JoiningMeasures& measures, RunControl& control);

}  // namespace remesh
