/// Chooses which nodes of a chain without a formula stay.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"
#include "core/patches/chains/chain_sections.h"

namespace remesh {

/// Returns the nodes between the ends of a chain that stay, ascending.
/// Input:  the points of the nodes; the last one equals the first one if the chain is closed. The chain lies on all of
///         the surfaces.
/// Output: few nodes, as evenly spaced along the chain as the limits allow. A closed chain keeps two or more, if it has
///         that many.
/// Holds:  the distance of a dropped node from its chord is at most its room, and dropped nodes are in order along the
///         chord. The normals of each surface turn by at most `turn_limit(limits.max_turn)` from a node that stays to
///         any other node up to the next one that stays, unless these two are neighbours.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n).
std::vector<std::uint32_t> thin_chain(std::span<const Vec3> points, std::span<const AnalyticSurface* const> surfaces,
                                      const ChainLimits& limits, const ChainRoom& room, const RunControl& control);

}  // namespace remesh
