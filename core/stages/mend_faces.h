/// Makes every face of the working surface one that has a plane: splits polygons that have none, drops zero-area faces.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/report.h"

namespace remesh {

/// Mends the faces of a welded surface.
/// Output:  a surface that holds all that Surface promises. A polygon that is not planar within the tolerance, or that
///          crosses itself in its plane, comes as triangles in its place. Counts nonplanar_polygon and zero_area_face.
/// Holds:   closed stays closed: a zero-area face is dropped by handing the vertices on its longest edges to the faces
///          beyond them, so that each of its edges meets its counterpart.
/// Errors:  kEmptyMesh - no face has an area; kInvalidMesh - zero-area faces nest so deeply that mending them would
///          multiply the mesh.
/// Input:   the plane tolerance, in local units.
/// Returns: whether anything had to be mended; if not, faces, corners and vertices are as they were.
/// Cost:    O(n log n).
/// Source:  REFINEMENT, rule 17.
bool mend_faces(Surface& surface, double plane_tolerance, std::vector<Diagnostic>& diagnostics, RunControl& control);

/// Whether three points are exactly on one line (or coincide).
bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh
