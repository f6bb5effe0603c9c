/// Finds features that do not matter on a free-form surface.
#pragma once

#include <cstdint>

#include "core/base/run_control.h"
#include "core/free_form/ordered_input.h"

namespace remesh {

/// Takes features away that would keep vertices and say nothing about the shape. The surface stays within the tolerance
/// there anyway. On scans there are many of them:
/// - edges that turn by less than 60 degrees, if another feature, a border or an open edge runs beside them within 4
///   tolerances: most such edges make a rounded edge together, of which each facet turns too much for a smooth surface;
/// - chains of edges that have a loose end and are shorter than 8 tolerances or 4 edges, and closed chains that are
///   shorter than 8 tolerances.
/// Input:  a surface whose numbers depend on its places alone.
/// Output: the number of edges that are no longer features.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
std::uint64_t drop_minor_features(OrderedInput& input, double tolerance, RunControl& control);

}  // namespace remesh
