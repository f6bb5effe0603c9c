/// Drops faces that have no area.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Drops degenerate faces. Degenerate faces that share edges lie on one line, and form a cluster. Each cluster hands
/// its vertices to the faces around it, so that each edge still meets its counterpart.
/// Input:  `is_degenerate` has one entry per face. The corners of a face with 1 there are exactly on one line.
///         `keep_verbatim` has one entry per input face, or is empty; see mend_faces.
/// Output: the faces without the clusters. A cluster stays if a face marked in `keep_verbatim` would get its vertices.
/// Errors: kInvalidMesh - the faces nest so deeply that mending them would multiply the mesh.
/// Cost:   O(n log n).
/// Source: rules.md, Faces without area.
void drop_degenerate_faces(Surface& surface, const std::vector<std::uint8_t>& is_degenerate,
                           const std::vector<std::uint8_t>& keep_verbatim, RunControl& control);

}  // namespace remesh
