/// OFF, the Object File Format of Geomview, and its variants.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"

namespace remesh {

/// What the first word of an OFF file says its vertices carry.
struct OffKind {
  bool has_texture = false;     ///< ST
  bool has_colour = false;      ///< C
  bool has_normal = false;      ///< N
  bool is_homogeneous = false;  ///< 4
  bool has_dimension = false;   ///< n: their dimension follows the word
};

/// The kind of a first word such as `OFF`, `COFF` or `STCNOFF`; nothing if it is none.
std::optional<OffKind> off_kind(std::string_view word);

/// Reads OFF, as text or binary.
/// Input:   text: the word, the counts of vertices, faces and (not used) edges, behind it or on the next line; then a
///          line for each vertex and each face. Blank lines and comments (`#`) anywhere. Binary: `OFF BINARY`, then
///          numbers of 4 bytes, big end first.
/// Output:  polygons as listed. What vertices carry beyond x, y, z and faces beyond their corners is counted as
///          attribute_dropped, zeros that pad the text as trailing_bytes.
/// Errors:  with the line or byte: kInvalidMesh - not OFF, coordinates that are not 3, a line that is none, data that
///          ends early or goes on; kIndexOutOfRange, kNonfiniteCoordinate - also with the element; kMeshTooLarge - past
///          `limits`. kEmptyMesh - no face; kCancelled, kTimeout - through `control`.
/// Cost:    O(content); nothing is reserved that the content has no room for.
ReadResult read_off(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes OFF text: `OFF`, counts, vertices, faces, and `comments` as `#` lines at the end, the one place where all
/// readers pass over them. Labels are lost.
/// Holds:  every number is the shortest text that reads back to the same double.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_off(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

}  // namespace remesh
