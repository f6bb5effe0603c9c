/// From the mesh as read to the working surface: vertices with equal coordinates, or nearly equal ones, become one.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Welds vertices by value (-0 equals 0), or within a tolerance, and drops those that no face uses.
/// Input:   `tolerance` in model units: above 0, a vertex becomes one with the lexicographically smallest within that
///          distance which has not itself become another. So none moves further, and chains of near vertices do not
///          collapse; members of wider clusters are counted.
/// Output:  the surface with faces and corners as listed, vertices ordered by their first appearance in the input's
///          numbering; `face_label` numbers the combinations of the labels in `barriers`, in order of first use. What a
///          Surface holds about faces is not yet so: see mend_faces.
///          Counts duplicate_vertex and unused_vertex. What of the input stays as it is, the surface looks at only.
/// Errors:  kEmptyMesh - no face; kCoordinateRange - a vertex 2^1022 from the centre or further, or all nearer to it
///          than 2^-1022 but not in one place, or all on a line but for less than 2^-100 of its length
///          (CoordinateRange); kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
Surface weld(const PolygonMesh& input, const Barriers& barriers, std::vector<Diagnostic>& diagnostics,
             RunControl& control, double tolerance = 0);

}  // namespace remesh
