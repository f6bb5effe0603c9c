/// Reads and writes Gmsh's mesh format.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/common/format.h"

namespace remesh {

/// Reads `.msh`.
/// Input:   version 2.x or 4.1, as text or as binary with numbers of 8 bytes, of either byte order. Nodes must come
///          before elements.
/// Output:  the triangles and quadrilaterals in the order of the file, those of higher order by their corners. Physical
///          groups are groups: those of the elements in version 2, and the first one of each surface in version 4. They
///          have the names of physical groups of dimension 2, else their digits. Elements that are no faces, and nodes
///          on edges, are counted as attribute_dropped.
/// Errors:  with the line or byte: kInvalidMesh - not Gmsh's format, another version, a section that does not follow
///          it, a number that two nodes have, a type of elements that is not known; kIndexOutOfRange,
///          kNonfiniteCoordinate - also with the element; kMeshTooLarge - more than `limits`. kEmptyMesh - no face;
///          kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n), or O(n) if the nodes are numbered 1, 2, 3, ...
ReadResult read_msh(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes `.msh` as text, in version 2.2 or 4.1. Each patch is an elementary entity. Each boundary (boundaries.h) is a
/// physical group of its name; a patch that belongs to several boundaries is several entities. If the surfaces of the
/// patches are known, each face has the number of its surface in an element data section named `surface`, which Gmsh
/// shows as a view. `comments` are in a section `$Comments`. If the surface encloses volumes, `$PhysicalNames` also
/// names one physical volume, and the comments have the lines of Gmsh's language that make this volume and its
/// elementary parts. Without these lines `gmsh -3` makes no tetrahedra. The file has no entity of dimension 3, because
/// `gmsh -3` would then refuse to make any.
/// Holds:  every number is the shortest text that reads back to the same double; no name contains the end of a line; no
///         number stands for two physical groups. The nodes and triangles have the numbers of the vertices and faces,
///         from 1.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_msh(const WriterInput& input, RunControl& control);

/// The lines of Gmsh's language that are in the comments of a file by write_msh.
/// Output: none if the surface does not enclose volumes, or if it is not clear which.
/// Errors: as enclosed_volumes.
std::vector<std::string> msh_filling(const WriterInput& input, RunControl& control);

/// The boundaries that write_msh makes physical groups of. Without a change, a name has no quotes or line ends.
Boundaries msh_boundaries(const WriterInput& input, RunControl& control);

}  // namespace remesh
