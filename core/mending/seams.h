/// Seams: open edges whose partners run beside them, no further off than the coordinates are rounded.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Joins the two sides of seams, as where the last angle around a cylinder gave -6e-15 instead of 0.
/// Two open edges are partners if they run in opposite directions, as two faces of one surface do, the ends of one
/// within the tolerance of the ends of the other, and if no third one does. Edges no longer than twice the tolerance,
/// or of faces so thin (kThinFace), have no partners. Two sheets that lie on each other within a few tolerances are no
/// seam: joined, they would be a pocket without a volume.
/// Input:   a welded surface; the tolerance, in local units: what the rounding of the coordinates explains. Where the
///          sides of a seam are subdivided differently, split_t_junctions comes before and makes them alike.
/// Output:  the surface so mended, with Mend::kYes: the ends of partners have become one vertex, at the least place of
///          theirs in lexicographic order. Labels do not matter: they bound patches, not the surface. A polygon may
///          have a corner twice in a row after it (see mend_faces). Counts seam: the edges joined, or with Mend::kNo
///          those that would be; elements are a face of each.
///          Where so many open edges lie beside each other that all pairs are too many, none is joined, and that is
///          told.
/// Holds:   no vertex moves by more than the tolerance, and no two vertices further apart than it become one: chains of
///          near ones do not collapse. No face collapses, and no edge gets a third face or two that run along it the
///          same way; joins that would do so are left out. Vertices become one only where an edge between their faces
///          closes, so that none is pinched. The same whatever the order of faces and vertices.
/// Returns: whether the surface changed.
/// Cost:    O(b log b) in open edges; if some are joined, O(n) more. Nothing where none is open.
bool close_seams(Surface& surface, const Adjacency& edges, double tolerance, Mend mend,
                 std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
