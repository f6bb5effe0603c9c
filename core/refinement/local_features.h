/// How small the features of one patch are, seen from its segments.
#pragma once

#include <cstdint>
#include <numbers>
#include <vector>

#include "core/base/run_control.h"
#include "core/stages/patch_meshing.h"

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

/// Input:  the constrained half-edges of a patch that are segments.
/// Output: one entry each. Distances look at no more than a bounded number of triangles around a segment: they may be
///         too large where very many features crowd along a long one.
/// Cost:   O(n) in the patch.
std::vector<LocalFeature> local_features(const PatchMesh& patch, std::span<const std::uint32_t> sides,
                                         RunControl& control);

}  // namespace remesh
