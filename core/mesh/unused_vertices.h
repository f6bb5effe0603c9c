/// Removes vertices that no face uses.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Removes from a surface the vertices that no face uses. The others stay in their order and get new numbers.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(vertices + corners).
void drop_unused_vertices(Surface& surface, RunControl& control);

}  // namespace remesh
