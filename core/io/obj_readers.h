/// The two ways to read OBJ text, of which read_obj takes the faster one that will do. Both leave out padding at its
/// end, without a word.
#pragma once

#include <optional>
#include <string_view>

#include "core/io/formats.h"

namespace remesh {

/// Reads text of plain records only, in chunks of whole lines, on the caller's TBB arena.
/// Output:  what read_any_obj gives for it, whatever the number of threads; nothing if anything in the text is odd
///          (a line that is continued) or wrong: read_any_obj knows what to make of it, and on which line it stands.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(text), one look at each byte.
std::optional<ReadResult> read_plain_obj(std::string_view text, const ReadLimits& limits, RunControl& control);

/// Reads all of the grammar, one record at a time, faces and names through tinyobjloader. Output and errors: see
/// read_obj.
ReadResult read_any_obj(std::string_view text, const ReadLimits& limits, RunControl& control);

}  // namespace remesh
