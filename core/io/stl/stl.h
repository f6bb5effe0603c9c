/// Reads and writes STL, binary and text.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/run_control.h"
#include "core/io/common/boundaries.h"
#include "core/io/common/format.h"

namespace remesh {

/// True if the data is exactly as long as binary STL with its count of triangles is.
bool has_length_of_binary_stl(std::string_view content);
/// True if STL data is binary. This is recognised by the length, whatever the header contains (it may be "solid"), or
/// by zero bytes, which text does not have.
bool is_binary_stl(std::string_view content);

/// Reads STL of either kind.
/// Input:   binary: 80 bytes of header, a count, 50 bytes for each triangle. Text: keywords in upper or lower case.
///          Keywords that end something may be one word or two (`end loop`). Text after a keyword without a value is
///          skipped. Normals and comments (from `#`, `;`, `!` or `//` on) are skipped too, as are lines that begin
///          with no keyword before the first solid or before the first facet of a solid. A name is the rest of its
///          line, whatever that contains. A solid may also end at the end of the text or at the next `solid`.
/// Output:  the triangles in their order. STL repeats vertices for each triangle. Vertices with equal coordinates
///          become one, numbered by first appearance. Each solid of a text becomes an object of that name, even if
///          several have the same name. Floats are preserved exactly; numbers in text are read as doubles. Attribute
///          bytes (colours) are counted as attribute_dropped. Up to 49 bytes after the last triangle, or zeros that
///          pad a text, are counted as trailing_bytes.
/// Errors:  with the line or byte: kInvalidMesh - not STL, a facet that is no triangle, data that ends early or
///          continues beyond its count; kNonfiniteCoordinate; kMeshTooLarge - more than `limits`. kEmptyMesh - no
///          triangle; kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
ReadResult read_stl(std::string_view content, const ReadLimits& limits, RunControl& control);

/// Writes binary STL. Labels are lost, and the header has room for the first line of `comments` only.
/// Input:   `mesh` - all its coordinates must be floats, because the format has no other numbers (see
///          round_for_format). They are not rounded here.
/// Errors:  kInternal - a coordinate is not a float; kOutputTooLarge - more triangles than 32 bits can count;
///          kCancelled, kTimeout - through `control`.
/// Cost:    O(output).
std::string write_stl(const TriangleMesh& mesh, const std::vector<std::string>& comments, RunControl& control);

/// Writes STL as text, with the shortest digits that read back to the same doubles. Each boundary becomes a solid of
/// its name (boundaries.h). A mesh without such labels becomes one solid without a name, and so does any mesh with
/// StlSolids::kOne. Text STL has no place for comments.
/// Output:  the solids in the order of their boundaries, and the faces of each in the order of the mesh.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(output).
std::string write_stl_ascii(const WriterInput& input, RunControl& control);

/// The boundaries that write_stl_ascii makes solids of.
/// Output:  nothing if it makes one solid without a name.
std::optional<Boundaries> stl_boundaries(const WriterInput& input, RunControl& control);

}  // namespace remesh
