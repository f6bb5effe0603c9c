/// How small the features of one patch are, seen from its segments.
#pragma once

#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"

namespace remesh {

/// Of one side (a constrained half-edge) of a patch, in model units.
struct LocalFeature {
  double distance;  ///< to the nearest vertex or segment of the patch, seen from here, that does not touch the segment
  /// To the next segment of the patch at either end, counter-clockwise around that end: the half-edge that leaves it,
  /// and the angle between (radians, over all triangles there).
  std::uint32_t next_at_start;
  double angle_at_start;
  static constexpr double kWide = std::numbers::pi;  ///< stands for all angles over some 63 degrees
};

/// Finds them, patch after patch: most are small, and what it takes besides serves them all.
class LocalFeatures {
 public:
  /// Input:  the constrained half-edges of a patch that are segments.
  /// Output: one entry each, valid until the next call. Distances look at no more than a bounded number of triangles
  ///         around a segment: they may be too large where very many features crowd along a long one.
  /// Cost:   O(n) in the patch.
  std::span<const LocalFeature> of(const PatchMesh& patch, std::span<const std::uint32_t> sides, RunControl& control);

 private:
  /// A triangle that was entered, by the half-edge, and how far that one's ends are from the segment, squared.
  struct Entered {
    std::uint32_t half_edge;
    double from_distance, to_distance;
  };

  double distance(const PatchMesh& patch, std::uint32_t side);

  std::vector<LocalFeature> features_;
  std::vector<std::uint32_t> seen_;  ///< the half-edge whose search has entered a triangle last
  std::vector<Entered> queue_;
};

}  // namespace remesh
