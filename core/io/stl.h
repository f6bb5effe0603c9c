/// STL, binary and text.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/io/formats.h"

namespace remesh {

/// Whether data is as long as the count of triangles in it says for binary STL.
bool has_length_of_binary_stl(std::string_view content);
/// Whether STL is binary: known by its length, whatever the header says ("solid", too), or by the zero bytes that it
/// has where no text has them.
bool is_binary_stl(std::string_view content);

/// Reads STL of either kind.
/// Input:   binary: 80 bytes of header, a count, 50 bytes a triangle. Text: keywords in upper or lower case, those that
///          end something in one word or in two (`end loop`). What stands behind a keyword that takes no value is
///          skipped, as are the normals, comments (from `#`, `;`, `!` or `//` on), and lines that begin with no keyword
///          before the first solid or before a solid's first facet. A name is the rest of its line, whatever that
///          holds. The end of the text or the next `solid` may end a solid, too.
/// Output:  triangles as listed. STL repeats a vertex for each triangle: those with equal coordinates are one, numbered
///          by first appearance. Each solid of a text becomes an object of that name, also where several have one name.
///          Floats are kept exactly, numbers of text are read as doubles. Attribute bytes (colours) are counted as
///          attribute_dropped, up to 49 bytes after the last triangle, or zeros that pad a text, as trailing_bytes.
/// Errors:  with the line or byte: kInvalidMesh - not STL, a facet that is no triangle, data that ends early or goes on
///          beyond its count; kNonfiniteCoordinate; kMeshTooLarge - past `limits`. kEmptyMesh - no triangle;
///          kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
ReadResult read_stl(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes binary STL. Labels are lost, and the header takes no more of `comments` than their first line.
/// Input:   coordinates that are floats, the only numbers that it has: see round_output. None is rounded here.
/// Errors:  kInternal - a coordinate is no float; kOutputTooLarge - more triangles than 32 bits count; kCancelled,
///          kTimeout - through `control`.
/// Cost:    O(output).
std::string write_stl(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

/// Writes STL as text, with the shortest digits that read back to the same doubles. Each group is a solid of its name,
/// or each object where there are no groups, or each material where there are neither; else all is one solid without a
/// name. Text STL has no place for comments.
/// Output:  the solids in the order of their labels, the faces of each in theirs.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(output).
std::string write_stl_ascii(const TriangleMesh& mesh, RunControl& control);

}  // namespace remesh
