/// Wavefront OBJ, read and written in doubles.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"

namespace remesh {

/// Reads OBJ text.
/// Input:   the whole text; line ends LF, CRLF or CR; continued lines (`\`); a UTF-8 byte-order mark is skipped.
/// Output:  polygons as listed; one object, group and material per face where the file names them; vertices in file
///          order, coordinates correctly rounded.
/// Holds:   no file is opened, whatever `mtllib` names.
/// Errors:  kInvalidMesh, kIndexOutOfRange, kNonfiniteCoordinate - with the line; kMeshTooLarge - past `limits`;
///          kEmptyMesh - no face.
/// Source:  faces, groups, objects and materials through tinyobjloader's callbacks; coordinates by std::from_chars.
ReadResult read_obj(std::string_view text, const ReadLimits& limits, RunControl& control);

/// Writes OBJ text: `comments` as `#` lines first, then vertices, then faces by label (`o`, `g`, `usemtl`).
/// Holds: every number is the shortest text that reads back to the same double.
std::string write_obj(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
