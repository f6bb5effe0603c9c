/// Files of the command line: `-` is standard input or output.
#pragma once

#include <cstddef>
#include <memory>
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

/// The bytes of a file.
class FileContent {
 public:
  /// All that can be read from an open file; `path` names it in errors. Errors: as read_file.
  static FileContent read(int fd, const std::string& path, const RunControl& control);

  std::string_view view() const { return {bytes_.get(), size_}; }
  /// Gives the memory back, when nobody looks at it any more.
  void release() { *this = FileContent(); }

 private:
  void reserve(std::size_t size);

  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// The whole file.
/// Errors: FileError; kCancelled - a signal came and `control` says to stop.
FileContent read_file(const std::string& path, const RunControl& control);

/// Writes the whole file or none of it: into a new file beside it first, which then takes its place. What is no
/// ordinary file, such as /dev/null or a pipe, is written as it is.
/// Errors: FileError; nothing is left behind.
void write_file(const std::string& path, std::string_view content);

/// Looks whether write_file could write there, before much work is done for it.
/// Errors: FileError - the folder is missing or may not be written to; it is a folder itself.
void check_writable(const std::string& path);

/// A file that grows while its content comes about, so that it has some if this process ends early. Only an ordinary
/// one: anything else stays as it is. Who has all of the content writes the file by write_file, which also tells
/// errors.
class Draft {
 public:
  explicit Draft(const std::string& path);
  ~Draft();
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;

  void append(std::string_view text);

 private:
  int fd_ = -1;
};

}  // namespace remesh::cli
