/// Faces that repeat another one.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Finds faces over the same loop of vertices and drops all but the first of each.
/// A face that repeats another one seen from behind is dropped only where that is right: where, with all of its
/// connected kind gone, each of its edges has exactly two faces. Else it stays: it is the other side of a sheet, or
/// the wall of a second solid, and without it the surface would be open or would have edges of three faces.
/// Input:   a welded surface. A polygon that touches itself is not looked at.
/// Output:  the surface without them, with Mend::kYes. Counts duplicate_face, those dropped and those left apart.
/// Returns: whether the surface changed.
/// Cost:    O(n).
bool drop_duplicate_faces(Surface& surface, const Adjacency& edges, Mend mend, std::vector<Diagnostic>& diagnostics,
                          RunControl& control);

}  // namespace remesh
