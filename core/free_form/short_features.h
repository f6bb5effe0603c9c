/// Finds features that are too short to matter on a free-form surface.
#pragma once

#include <cstdint>

#include "core/base/run_control.h"
#include "core/free_form/ordered_input.h"

namespace remesh {

/// Takes features away that say nothing about the shape: chains of feature edges that have a loose end and are shorter
/// than 8 tolerances or 4 edges, and closed chains that are shorter than 8 tolerances. On scans there are many of them,
/// and they would keep vertices. The surface stays within the tolerance there anyway.
/// Input:  a surface whose numbers depend on its places alone.
/// Output: the number of edges that are no longer features.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n).
std::uint64_t drop_short_features(OrderedInput& input, double tolerance, RunControl& control);

}  // namespace remesh
