/// Tells whether faces bend as rounding bends them.
#pragma once

#include <cstddef>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/face_geometry.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Rounding bends each pair of faces by another amount. One bend, or the same one in several places, may be part of the
/// shape: a crown, or the facets of a cylinder. So many different ones are noise.
inline constexpr std::size_t kBendsOfNoise = 3;

/// Whether well-shaped neighbours bend by more than `floor` and at most `tolerance` (local units), by so many different
/// amounts. Polygons that leave their own plane by as much count as pairs do.
/// Input:  at most kBendsOfNoise amounts.
/// Holds:  says the same of faces wound as they should be and of others, of each once and of each several times, and in
///         any order: mending comes later.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
bool is_noise_present(const Surface& surface, const Adjacency& adjacency, const FaceGeometries& geometry, double floor,
                      double tolerance, std::size_t amounts, RunControl& control);

}  // namespace remesh
