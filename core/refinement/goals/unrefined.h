/// Finds the triangles that do not meet the goals of a refinement.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/goals/unrefined_reason.h"

namespace remesh {

/// These values mean that a face is larger than gaps or short edges allow, or that it is not known whether it is. 0
/// stands for a face that is small enough.
inline constexpr std::uint8_t kMissesSizes = 1, kMayMissSizes = 2;

struct UnrefinedFaces {
  std::vector<FaceId> faces;  ///< ascending
  std::vector<UnrefinedReason> reasons;
  std::vector<std::uint8_t> misses_sizes;  ///< 0, kMissesSizes, or kMayMissSizes for each of these faces
};

/// Finds the triangles that miss a goal. They are measured in space, with the output's doubles.
/// Input:  `reason` is the reason that refinement gives for each face. `misses_sizes` has one entry per face. It is
///         empty if all are 0.
/// Output: The triangles with an angle below the goal, or with an edge or an area above it by more than rounding, and
///         triangles that are larger, or may be larger, than gaps or short edges allow. Each has its reason. If a
///         triangle is listed only because it may be too large, the reason is kEffort.
/// Holds:  The result is the same for any number of threads.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(faces).
UnrefinedFaces find_unrefined(std::span<const Vec3> positions, std::span<const Triangle> faces,
                              std::span<const UnrefinedReason> reason, std::span<const std::uint8_t> misses_sizes,
                              const Goals& goals, RunControl& control);

/// The number of triangles that have an angle below a bound, and the smallest of their angles, in degrees.
struct SmallAngles {
  std::uint64_t count = 0;
  double least_deg = 180;

  void add(const SmallAngles& other) {
    count += other.count;
    least_deg = std::min(least_deg, other.least_deg);
  }
  /// Takes the larger count and the smaller angle of both.
  void take_worse(const SmallAngles& other) {
    count = std::max(count, other.count);
    least_deg = std::min(least_deg, other.least_deg);
  }
  bool are_worse_than(const SmallAngles& other) const { return count > other.count || least_deg < other.least_deg; }
};

/// Finds the triangles with an angle below the bound. `corners` has three for each triangle.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(faces).
SmallAngles small_angles(std::span<const Vec3> positions, std::span<const VertexId> corners, double bound_deg,
                         RunControl& control);

/// Groups by reason the triangles that find_unrefined found. For each reason, counts the triangles and lists the
/// centroids of the first ones. A floor that the program found itself counts as kSizeFloor.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
std::vector<Unrefined> summarise_unrefined(const UnrefinedFaces& unrefined, std::span<const Vec3> positions,
                                           std::span<const Triangle> faces, const Goals& goals, RunControl& control);

}  // namespace remesh
