/// Splits T-junctions: vertices that lie on an edge of a face without being corners of the face.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/common/mend_mode.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Splits open edges at those vertices of the open boundary that lie on them. The face becomes a polygon with these
/// vertices in its loop.
/// Input:   a welded surface; the tolerance, in local units. A vertex lies on an edge if it is within the tolerance of
///          the edge, further than that from both of the edge's ends (otherwise it is a matter of welding), and not a
///          corner of the edge's face. Faces marked in `keep_verbatim` (one entry per input face, or empty) get no
///          vertices, and neither do faces that are so thin (kThinFace) that a vertex might turn them over.
/// Output:  with MendMode::kYes, the mended surface. Counts T-junctions that were split and those that are left, each
///          as t_junction; elements are the vertices. If more than 4096 vertices plus 4 per corner of the surface are
///          near open edges, none is split, and this is reported. It happens if hundreds of edges lie along each other
///          with the same vertices on them.
/// Holds:   no point of the surface moves by more than the tolerance, and no face gets a vertex twice. Edges that run
///          along each other get the vertices on them in the same order, however near to each other these are. A
///          two-sided piece stays two-sided: a vertex that would twist the surface is left where it is.
/// Returns: whether the surface changed.
/// Cost:    O(b log b) for b open edges that are spread out; O(b sqrt b) if all of them lie along each other.
bool split_t_junctions(Surface& surface, const Adjacency& edges, double tolerance,
                       const std::vector<std::uint8_t>& keep_verbatim, MendMode mend,
                       std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
