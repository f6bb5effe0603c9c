/// Makes the working surface from the mesh as read. Vertices with equal coordinates, or nearly equal ones, become one.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Welds vertices by value (-0 equals 0), or within a tolerance, and drops vertices that no face uses.
/// Input:   `tolerance` is in model units. If it is above 0, a vertex becomes one with the lexicographically smallest
///          vertex within that distance which has not itself become another. So no vertex moves further than the
///          tolerance, and chains of near vertices do not collapse. The members of wider clusters are counted.
/// Output:  the surface, with faces and corners in the input's order and vertices in the order of their first
///          appearance in the input's numbering. `face_label` numbers the combinations of the labels in `barriers`, in
///          the order of their first use. The surface does not yet satisfy what Surface promises about faces: see
///          mend_faces. Counts duplicate_vertex and unused_vertex. The surface refers to those parts of the input that
///          do not change.
/// Errors:  kEmptyMesh - there is no face; kCoordinateRange - a vertex is 2^1022 from the centre or further, or all are
///          nearer to it than 2^-1022 but not in one place, or all are on a line except for less than 2^-100 of its
///          length (CoordinateRange); kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
Surface weld(const PolygonMesh& input, const Barriers& barriers, std::vector<Diagnostic>& diagnostics,
             RunControl& control, double tolerance = 0);

}  // namespace remesh
