/// PLY, text and binary of both byte orders.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"

namespace remesh {

/// Reads PLY.
/// Input:   a header whose lines end in LF, CRLF or CR, then a record for each element announced; in text, one a line.
/// Output:  polygons as listed, from the element `face` and its list `vertex_indices` or `vertex_index`; vertices from
///          x, y and z of the element `vertex`, of any number type, those of text as doubles. Whole numbers `object`,
///          `group` and `material` of a face are its labels, with the names that write_ply puts into comments, else
///          their digits. Other elements and properties are skipped, each counted as attribute_dropped; a few bytes
///          after the last record as trailing_bytes.
/// Errors:  with the line or byte: kInvalidMesh - not PLY, a record that does not fit the header, data that ends early
///          or goes on, triangle strips; kIndexOutOfRange, kNonfiniteCoordinate - also with the element; kMeshTooLarge
///          - past `limits`. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content); nothing is reserved that the content has no room for.
ReadResult read_ply(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes binary PLY, little end first, coordinates as doubles. Labels are properties of the faces, with their names in
/// comments.
/// Holds:  read_ply gives back mesh and labels, bit for bit; a comment or name cannot make a header line.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_ply(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
