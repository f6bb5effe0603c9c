/// Wavefront OBJ, read and written in doubles.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"

namespace remesh {

/// Reads OBJ text.
/// Input:   the whole text; line ends LF, CRLF or CR; continued lines (`\`); a UTF-8 byte-order mark is skipped;
///          `fo` is the old word for `f`.
/// Output:  polygons as listed; one object, group and material per face where the file names them (several groups of
///          one face: one name, joined by blanks; before the first record of a kind: the empty name); vertices in file
///          order, coordinates correctly rounded, a missing z is 0. Each kind of record that does not describe the
///          surface (texture coordinates, normals, lines, ...) is counted in a diagnostic, NUL and
///          Ctrl-Z bytes that pad the text in trailing_bytes.
/// Holds:   no file is opened, whatever `mtllib` names; names are in the order in which faces first bear them.
/// Errors:  kInvalidMesh, kIndexOutOfRange, kNonfiniteCoordinate - with the line, and the element if it is of one;
///          kMeshTooLarge - past `limits`, or a face of more than 4 million corners; kEmptyMesh - no face; kCancelled,
///          kTimeout - through `control`.
/// Cost:    O(text); plain records on the caller's TBB arena, see obj_readers.h.
ReadResult read_obj(std::string_view text, const ReadLimits& limits, RunControl& control);

/// Writes OBJ text: `comments` as `#` lines, the `mtllib` records, vertices, faces in their order; `o`, `g` and
/// `usemtl` stand where the label changes.
/// Holds:  every number is the shortest text that reads back to the same double; read_obj gives back mesh and labels; a
///         comment or name cannot make a record, whatever is in it.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(output).
std::string write_obj(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
