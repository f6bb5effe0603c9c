/// How the command line reports failures: by exit codes and one line of text.
#pragma once

#include <exception>
#include <string>

#include "core/base/error.h"

namespace remesh::cli {

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kMisused = 2;
inline constexpr int kNotWithin = 3;  ///< two meshes are farther apart than the tolerance

/// Returns kMisused for errors that follow from the command line alone, and kFailed for errors that depend on the
/// mesh, even if it only exceeds an option's bound.
int exit_code(const Error& error);

/// Returns the place of an error in the input: `part.obj:12`, `part.stl: byte 84`, or the name alone. The input `-`
/// is standard input.
std::string place_of(const Error& error, const std::string& input);

/// Describes an error in one line: `part.obj:12: index_out_of_range: a face ...`
std::string describe(const Error& error, const std::string& input);

/// A failure of any kind. `code` is the API's code, or `file_error`, `out_of_memory` or `internal`; `message` describes
/// the failure.
struct Failure {
  int exit_code = kFailed;
  std::string code;
  std::string message;
  std::string line;  ///< place, code and message as `describe` gives them
};

/// Converts an exception to a failure.
/// Input: `input` - the file that was processed.
Failure failure_of(const std::exception_ptr& thrown, const std::string& input);

}  // namespace remesh::cli
