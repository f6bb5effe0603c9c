/// Decides which curved surfaces keep their facets because these are coarser than what would take their place.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/curve_cuts.h"
#include "core/patches/curved_patches.h"
#include "core/patches/partition.h"

namespace remesh {

/// What the facets of curved patches would cost if they stayed. A vertex on a boundary costs a face on its other side,
/// too, so boundaries count with the faces.
class CoarserFacets {
 public:
  /// Counts the faces that the facets become.
  /// Input:  the partition into facets, and the patches that are joined from them.
  /// Output: the estimate is rather too low: where both ways cost about the same, the facets are to stay. So a larger
  ///         tolerance never makes more faces, as the cost of joined patches falls while it grows.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n).
  void count_facets(const Surface& surface, const Adjacency& adjacency, const Partition& facets,
                    const CurvedPatches& joined, double min_angle_deg, RunControl& control);
  /// Returns the surfaces whose facets are so coarse that no refinement of joined patches could make fewer faces. To find
  /// that out by refining them could take far more work than the result is worth.
  /// Input: the joined patches with their limits, whose facets have been counted.
  std::vector<SurfaceId> find_hopeless(const CurvedPatches& joined, const Options& options) const;
  /// Counts the boundary vertices of the joined patches, before their boundaries are cut and after that.
  /// Cost:   O(n log n).
  void count_boundaries(const Adjacency& adjacency, const Partition& joined, const CurvedPatches& curved,
                        const CurveCuts* cuts, RunControl& control);

  /// Returns the curved patches of the surfaces whose facets are coarser, and as fine as is asked for.
  /// Input:  the number of triangles that each patch has, after refinement.
  std::vector<PatchId> find(const CurvedPatches& curved, const std::vector<std::uint64_t>& triangles,
                            const Options& options) const;

 private:
  /// Counts of one joined patch.
  struct Cost {
    double facets = 0;
    std::uint64_t boundary_before = 0, boundary_after = 0;
  };
  IdVector<PatchId, Cost> costs_;
};

}  // namespace remesh
