/// T-junctions: vertices that lie on an edge of a face that does not have them.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Splits open edges at the open boundary's vertices that lie on them: the face becomes a polygon with these vertices
/// in its loop.
/// Input:   a welded surface; the tolerance, in local units. A vertex lies on an edge if it is within the tolerance of
///          it and further than that from both its ends (else it is a matter of welding), and is not the face's own.
///          Faces marked in `as_it_is` (per input face, or empty) are handed none, nor are faces so thin (kThinFace)
///          that they might be turned over by it.
/// Output:  the surface so mended, with Mend::kYes. Counts t_junction, those split and those left;
///          elements are the vertices.
///          Where more vertices are near open edges than 4 a corner of the surface and 4096, as where edges lie along
///          each other by the hundred with the same vertices on them, none is split, and that is told.
/// Holds:   no point of the surface moves by more than the tolerance; no face is handed a vertex twice. Edges that run
///          along each other get the vertices on them in the same order, however near these are to each other. What has
///          two sides keeps them: a vertex that would twist the surface is left where it is.
/// Returns: whether the surface changed.
/// Cost:    O(b log b) in open edges where these are spread out; where all lie along each other O(b sqrt b).
bool split_t_junctions(Surface& surface, const Adjacency& edges, double tolerance,
                       const std::vector<std::uint8_t>& as_it_is, Mend mend, std::vector<Diagnostic>& diagnostics,
                       RunControl& control);

}  // namespace remesh
