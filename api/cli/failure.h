/// How the command line tells failures: exit codes and one line of text.
#pragma once

#include <exception>
#include <string>

#include "core/base/error.h"

namespace remesh::cli {

inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kMisused = 2;

/// What the command line alone decides is misuse; what the mesh decides is a failure, be it at an option's bound.
int exit_code(const Error& error);

/// `part.obj:12`, `part.stl: byte 84`, or the name alone: where in the input the error is. `-` is standard input.
std::string place_of(const Error& error, const std::string& input);

/// `part.obj:12: index_out_of_range: a face ...`
std::string describe(const Error& error, const std::string& input);

/// A failure of any kind: the contract's code, or `file_error`, `out_of_memory`, `internal`; and what happened.
struct Failure {
  int exit_code = kFailed;
  std::string code;
  std::string message;
  std::string line;  ///< all of it, as `describe`
};

/// What was thrown while `input` was worked on.
Failure failure_of(const std::exception_ptr& thrown, const std::string& input);

}  // namespace remesh::cli
