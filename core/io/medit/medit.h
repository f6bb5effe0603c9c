/// Reads and writes Medit's mesh format as text.
#pragma once

#include <string>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/common/format.h"

namespace remesh {

/// Reads `.mesh`.
/// Input:   text of any version, in three dimensions. `Vertices` must come before faces.
/// Output:  the polygons of `Triangles` and `Quadrilaterals`, in the order of the file. If any reference of a face is
///          not 0, the references are groups. Their names are those that write_medit puts into comments, else their
///          digits. Records of other keywords (`Edges`, `Tetrahedra`, `Corners`, ...) are skipped, and counted as
///          attribute_dropped.
/// Errors:  with the line: kInvalidMesh - not Medit's format, an incomplete record, not three dimensions;
///          kIndexOutOfRange, kNonfiniteCoordinate - also with the element; kMeshTooLarge - more than `limits`.
///          kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content log references).
ReadResult read_medit(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes `.mesh` of version 2, the only one that Gmsh, FreeFEM, meshio and TetGen all read as doubles. Each boundary
/// (boundaries.h) has its number as the reference of its triangles, from 1 on, because Gmsh's interface takes -1 for
/// all, and references of 0 are none. Comments have `comments`, and a line `# reference 1: NAME` for each boundary.
/// Holds:   every number is the shortest text that reads back to the same double; no name can end its line.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(output).
std::string write_medit(const WriterInput& input, RunControl& control);

}  // namespace remesh
