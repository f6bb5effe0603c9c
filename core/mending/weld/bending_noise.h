/// Tests whether faces bend in the way in which rounding bends them.
#pragma once

#include <cstddef>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"

namespace remesh {

/// The number of different bends that count as noise. Rounding bends each pair of faces by another amount. A single
/// bend, or the same one in several places, may be part of the shape: a crown, or the facets of a cylinder.
inline constexpr std::size_t kBendsOfNoise = 3;

/// Returns whether well-shaped neighbours bend by more than `floor` and at most `tolerance` (local units), by at least
/// `amounts` different amounts. A polygon counts like a pair if it leaves its own plane by such an amount.
/// Input:  `amounts` is at most kBendsOfNoise.
/// Holds:  the result does not depend on the winding of the faces, on repeated faces, or on any order, because these
///         are mended later.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
bool is_noise_present(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry, double floor,
                      double tolerance, std::size_t amounts, RunControl& control);

}  // namespace remesh
