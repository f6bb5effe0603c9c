/// Decides which curved surfaces keep their facets because these are coarser than the remeshed patches would be.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/curve_cuts.h"
#include "core/patches/curved_goals.h"
#include "core/patches/curved_patches.h"
#include "core/patches/partition.h"

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
  ///        proportion to the input (Goals::faces_without_floor).
  std::vector<SurfaceId> find_hopeless(const CurvedPatches& joined, const CurvedGoals& goals,
                                       std::uint64_t in_proportion) const;
  /// Counts the boundary vertices of the joined patches, before their boundaries are cut and after that.
  /// Cost:   O(n log n).
  void count_boundaries(const Adjacency& adjacency, const Partition& joined, const CurvedPatches& curved,
                        const CurveCuts* cuts, RunControl& control);

  /// Finds surfaces whose facets may be coarser than their joined patches, and stores the numbers of triangles of the
  /// joined patches.
  /// Input:  the number of triangles that each patch has, after refinement.
  /// Output: the curved patches of these surfaces. No surface is found twice. After the first time, none is found if
  ///         that would save hardly any faces, because all patches are then refined again.
  std::vector<PatchId> find_coarser(const CurvedPatches& curved, const std::vector<std::uint64_t>& triangles,
                                    const CurvedGoals& goals);
  /// Finds surfaces that find_coarser has found, but whose facets have more triangles after refinement than the joined
  /// patches had.
  /// Input:  the surface of each patch, and the number of its triangles; `is_left` tells whether the patch is a facet
  ///         that stayed.
  std::vector<SurfaceId> find_finer(const IdVector<PatchId, SurfaceId>& of_patch,
                                    const std::vector<std::uint64_t>& triangles,
                                    const std::vector<std::uint8_t>& is_left);
  bool is_any_left() const { return left_ > 0; }

 private:
  /// Counts of one joined patch.
  struct Cost {
    double facets = 0;
    double joined = 0;  ///< the expected number of faces of the joined patch by its limits
    std::uint64_t boundary_before = 0, boundary_after = 0;
  };
  /// The max number of triangles of a surface's facets, for surfaces that were found.
  IdVector<SurfaceId, std::optional<double>> allowed_;
  std::size_t left_ = 0;  ///< surfaces whose facets stayed, and have not been compared yet
  IdVector<PatchId, Cost> costs_;
};

}  // namespace remesh
