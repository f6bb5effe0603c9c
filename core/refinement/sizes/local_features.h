/// Finds how small the features of one patch are around each of its segments.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patches/charts/patch_chart.h"

namespace remesh {

/// Describes the surroundings of one side (a constrained half-edge) of a patch, in model units.
struct LocalFeature {
  /// The distance to the nearest vertex or segment of the patch that is seen from this side and does not touch the
  /// segment.
  double distance;
  /// The next segment of the patch, counter-clockwise around the start of this one, as a half-edge that ends there. The
  /// angle between the two is in radians, over all triangles between them.
  std::uint32_t next_at_start;
  double angle_at_start;
  static constexpr double kWide = std::numbers::pi;  ///< stands for all angles above some 63 degrees
};

/// Finds the local features of one patch after the other. Most patches are small, so all of them share the scratch
/// memory.
class LocalFeatures {
 public:
  /// Input:  `sides` are the constrained half-edges of the patch that are segments.
  /// Output: One entry for each side, valid until the next call. The search visits a bounded number of triangles around
  ///         a segment. So a distance may be too large where very many features crowd along a long segment.
  /// Cost:   O(n) in the size of the patch.
  std::span<const LocalFeature> of(const PatchMesh& patch, const PatchChart& chart,
                                   std::span<const std::uint32_t> sides, RunControl& control);

 private:
  /// A triangle that the search has entered through a half-edge, and the squared distances of that half-edge's ends
  /// from the segment.
  struct Entered {
    std::uint32_t half_edge;
    double from_distance, to_distance;
  };

  double distance(const PatchMesh& patch, std::uint32_t side);

  std::vector<LocalFeature> features_;
  std::vector<std::uint32_t> seen_;  ///< the side whose search was the last to enter each triangle
  std::vector<Entered> queue_;
};

}  // namespace remesh
