/// Files of the command line. The name `-` means standard input or standard output.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
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
  /// Reads everything from an open file.
  /// Input: `path` - names it in errors.
  /// Errors: as read_file.
  static FileContent read(int fd, const std::string& path, const RunControl& control);

  std::string_view view() const { return {bytes_.get(), size_}; }
  /// Frees the memory. Views of it become invalid.
  void release() { *this = FileContent(); }

 private:
  void reserve(std::size_t size);

  std::unique_ptr<char[]> bytes_;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

/// Reads a whole file.
/// Errors: FileError; kCancelled - a signal came and `control` was asked to stop.
FileContent read_file(const std::string& path, const RunControl& control);

/// Writes the whole file or nothing: the content goes into a new file in the same folder, which then replaces the old
/// one. A target that is not an ordinary file, such as /dev/null or a pipe, is written directly.
/// Errors: FileError; no temporary file is left behind.
void write_file(const std::string& path, std::string_view content);
void write_file(const std::string& path, std::span<const std::string> pieces);

/// Checks that write_file can write to a path, before much work is done.
/// Errors: FileError - the folder is missing or not writable, or the path is a folder itself.
void check_writable(const std::string& path);

/// A file that grows while its content is made, so that it has some content if this process ends early. Only an
/// ordinary file is written; any other path is left alone. It reports no errors: once the content is complete, write
/// it by write_file.
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
