/// Finds the triangles that do not meet the goals of a refinement.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/refinement/goals.h"
#include "core/refinement/unrefined_reason.h"

namespace remesh {

struct UnrefinedFaces {
  std::vector<FaceId> faces;  ///< ascending
  std::vector<UnrefinedReason> reasons;
  std::vector<std::uint8_t> misses_sizes;  ///< whether each is larger than gaps or short edges ask for
};

/// Measures the triangles in space, on the output's doubles.
/// Input:   `reason`: what the refinement says of each face; `misses_sizes`: whether it is larger than gaps or short
///          edges ask for, one per face, or empty where none is.
/// Output:  those with an angle below the goal, or an edge or an area above it by more than rounding, and those larger
///          than gaps or short edges ask for, each with its reason.
/// Holds:   the same for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(faces).
UnrefinedFaces find_unrefined(std::span<const Vec3> positions, std::span<const Triangle> faces,
                              std::span<const UnrefinedReason> reason, std::span<const std::uint8_t> misses_sizes,
                              const Goals& goals, RunControl& control);

/// The same by reason, with places.
/// Errors:  kCancelled, kTimeout - through `control`.
std::vector<Unrefined> summarise_unrefined(const UnrefinedFaces& unrefined, std::span<const Vec3> positions,
                                           std::span<const Triangle> faces, RunControl& control);

}  // namespace remesh
