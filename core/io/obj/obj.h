/// Reads and writes Wavefront OBJ in doubles.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Reads OBJ text.
/// Input:   the whole text. Lines may end in LF, CRLF or CR and may be continued (`\`). A UTF-8 byte-order mark is
///          skipped. `fo` is the old keyword for `f`.
/// Output:  the polygons in their order, and the vertices in file order. Each face has one object, group and material
///          if the file names them. Several groups of one face become one name, joined by blanks. Before the first
///          record of a kind the name is empty. Coordinates are correctly rounded, and a missing z is 0. Each kind of
///          record that does not describe the surface (texture coordinates, normals, lines, ...) is counted in a
///          diagnostic. NUL and Ctrl-Z bytes that pad the text are counted as trailing_bytes.
/// Holds:   no file is opened, whatever `mtllib` names; names are in the order in which faces first have them.
/// Errors:  kInvalidMesh, kIndexOutOfRange, kNonfiniteCoordinate - with the line, and with the element if one is at
///          fault; kMeshTooLarge - more than `limits`, or a face of more than 4 million corners; kEmptyMesh - no
///          face; kCancelled, kTimeout - through `control`.
/// Cost:    O(text). Plain records are read on the caller's TBB arena, see obj_readers.h.
ReadResult read_obj(std::string_view text, const ReadLimits& limits, RunControl& control);

/// Writes OBJ text: `comments` as `#` lines, the `mtllib` records, the vertices, and the faces in their order. `o`,
/// `g` and `usemtl` are written where the label changes.
/// Holds:  every number is the shortest text that reads back to the same double; read_obj restores the mesh and its
///         labels; no comment or name can form a record, whatever it contains.
/// Errors: kCancelled, kTimeout - stopped through `control`.
/// Cost:   O(output).
std::string write_obj(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
