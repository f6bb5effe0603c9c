/// Reads and writes OFF, the Object File Format of Geomview, and its variants.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// The values that each vertex of an OFF file has, as the first word of the file announces them.
struct OffKind {
  bool has_texture = false;     ///< the word contains ST
  bool has_colour = false;      ///< the word contains C
  bool has_normal = false;      ///< the word contains N
  bool is_homogeneous = false;  ///< the word contains 4
  bool has_dimension = false;   ///< the word contains n: the number of dimensions follows it
};

/// Parses a first word such as `OFF`, `COFF` or `STCNOFF`.
/// Output: nothing if it is no such word.
std::optional<OffKind> off_kind(std::string_view word);

/// Reads OFF, as text or binary.
/// Input:   text: the first word, then the counts of vertices, faces and (not used) edges on the same or the next
///          line, then one line for each vertex and each face. Blank lines and comments (`#`) may occur anywhere.
///          Binary: `OFF BINARY`, then numbers of 4 bytes, most significant byte first.
/// Output:  the polygons in their order. Values of vertices beyond x, y, z and of faces beyond their corners are
///          counted as attribute_dropped, and zeros that pad the text as trailing_bytes.
/// Errors:  with the line or byte: kInvalidMesh - not OFF, not 3 coordinates, a malformed line, data that ends early
///          or continues after the last face; kIndexOutOfRange, kNonfiniteCoordinate - also with the element;
///          kMeshTooLarge - more than `limits`. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content); no more memory is reserved than the content has room for.
ReadResult read_off(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes OFF text: `OFF`, the counts, the vertices and the faces. `comments` follow as `#` lines at the end, which
/// is the only place where all readers skip them. Labels are lost.
/// Holds:  every number is the shortest text that reads back to the same double.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_off(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
