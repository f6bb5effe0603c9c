/// Decides which curved surfaces keep their facets because these are coarser than the remeshed patches would be.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/chains/curve_cuts.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/curved_goals.h"
#include "core/patches/meshing/partition.h"

namespace remesh {

/// Compares the cost of curved patches with that of their facets. A vertex on a boundary costs a face on its other
/// side, too, so boundaries count with the faces.
class CoarserFacets {
 public:
  /// Counts the faces that the facets become.
  /// Input:  the partition into facets, and the patches that are joined from them.
  /// Output: the estimate is low rather than high, so that facets stay where both ways cost about the same. So a larger
  ///         tolerance never makes more faces, as the cost of joined patches falls while it grows.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n).
  void count_facets(const Surface& surface, const Adjacency& adjacency, const Partition& facets,
                    const CurvedPatches& joined, double min_angle_deg, RunControl& control);
  /// Returns the surfaces whose facets are so coarse that no refinement of joined patches could make fewer faces, and
  /// surfaces that would have more faces than are in proportion: a min edge length makes no curved patch coarser.
  /// Finding that out by refinement could take far more work than the result is worth.
  /// Input: the joined patches with their limits, whose facets have been counted; and the number of faces that is in
  ///        proportion to the input (Goals::faces_without_min_edge).
  std::vector<SurfaceId> find_hopeless(const CurvedPatches& joined, const CurvedGoals& goals,
                                       std::uint64_t in_proportion) const;
  /// Counts the boundary vertices of the joined patches, before their boundaries are cut and after that.
  /// Cost:   O(n log n).
  void count_boundaries(const Adjacency& adjacency, const Partition& joined, const CurvedPatches& curved,
                        const CurveCuts* cuts, RunControl& control);

  /// Facets that should be left, and how many triangles the facets of their surfaces may have then.
  struct Coarser {
    std::vector<PatchId> patches;
    std::vector<std::pair<SurfaceId, double>> allowed;
  };
  /// Finds surfaces whose facets may be coarser than their joined patches.
  /// Input:  the number of triangles that each patch has, after refinement; and what is allowed to surfaces that were
  ///         found before.
  /// Output: their curved patches. No surface is found twice. After the first time, none is found if hardly any faces
  ///         would be saved, since all is refined again for that.
  Coarser find_coarser(const CurvedPatches& curved, const std::vector<std::uint64_t>& triangles,
                       const IdVector<SurfaceId, std::optional<double>>& allowed, const CurvedGoals& goals) const;

 private:
  /// Counts of one joined patch.
  struct Cost {
    double facets = 0;
    double joined = 0;  ///< the expected number of faces of the joined patch by its limits
    std::uint64_t boundary_before = 0, boundary_after = 0;
  };
  IdVector<PatchId, Cost> costs_;
};

/// Finds those surfaces whose facets were left, but have more triangles after refinement than they are allowed.
/// Input:  the surface of each patch, and the number of its triangles; `is_left` tells whether it is a facet that was
///         left.
std::vector<SurfaceId> find_finer(const IdVector<PatchId, SurfaceId>& of_patch,
                                  const std::vector<std::uint64_t>& triangles, const std::vector<std::uint8_t>& is_left,
                                  const IdVector<SurfaceId, std::optional<double>>& allowed);

}  // namespace remesh
