/// Files of the command line: `-` is standard input or output.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "core/base/run_control.h"

namespace remesh::cli {

/// A file cannot be read or written; the message names it and says why.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The whole file.
/// Errors: FileError; kCancelled - a signal came and `control` says to stop.
std::string read_file(const std::string& path, const RunControl& control);

/// Writes the whole file or none of it: into a new file beside it first, which then takes its place. What is no
/// ordinary file, such as /dev/null or a pipe, is written as it is. Errors: FileError; nothing is left behind.
void write_file(const std::string& path, std::string_view content);

}  // namespace remesh::cli
