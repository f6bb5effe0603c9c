/// Reads and writes PLY, as text and as binary of both byte orders.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Reads PLY.
/// Input:   a header whose lines end in LF, CRLF or CR, then a record for each announced element. In text, each
///          record is one line.
/// Output:  the polygons in their order, from the list `vertex_indices` or `vertex_index` of the element `face`.
///          Vertices come from x, y and z of the element `vertex`, which may have any number type; in text they are
///          read as doubles. Whole numbers `object`, `group` and `material` of a face are its labels. Its groups are
///          the first one that there is of `limits.ply_labels`, without which these are `group`, `group_id`, `layer_id`
///          and `material_index`. Their
///          names are those that write_ply puts into comments, else their digits. Other elements and properties are
///          skipped, and each is counted as attribute_dropped. A few bytes after the last record are counted as
///          trailing_bytes.
/// Errors:  with the line or byte: kInvalidMesh - not PLY, a record that does not fit the header, data that ends
///          early or continues, triangle strips; kIndexOutOfRange, kNonfiniteCoordinate - also with the element;
///          kMeshTooLarge - more than `limits`. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content); no more memory is reserved than the content has room for.
ReadResult read_ply(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes binary PLY, least significant byte first, with coordinates as doubles. Labels are properties of the faces,
/// and their names are in comments.
/// Holds:  read_ply restores the mesh and its labels bit for bit; no comment or name can form a header line.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_ply(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

/// Writes PLY as text, with the shortest digits that read back to the same doubles. Everything else is as in write_ply.
/// Some programs (Gmsh, meshio with labels) read only this form.
std::string write_ply_ascii(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
