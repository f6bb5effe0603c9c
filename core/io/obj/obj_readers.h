/// The two readers of OBJ text. read_obj uses the faster one if that is able to read the text. Both skip padding at
/// the end without a diagnostic.
#pragma once

#include <optional>
#include <string_view>

#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Reads text that consists of plain records only, in chunks of whole lines, on the caller's TBB arena.
/// Output:  the same as read_obj_full_grammar, for any number of threads. It is nothing if anything in the text is
///          unusual (such as a continued line) or wrong; read_obj_full_grammar can then read it or report the error
///          with its line.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(text); each byte is read once.
std::optional<ReadResult> read_obj_fast_path(std::string_view text, const ReadLimits& limits, RunControl& control);

/// Reads the whole grammar, one record at a time. Faces and names go through tinyobjloader.
/// Output:  see read_obj.
/// Errors:  see read_obj.
ReadResult read_obj_full_grammar(std::string_view text, const ReadLimits& limits, RunControl& control);

}  // namespace remesh
