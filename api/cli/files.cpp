#include "api/cli/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/prefault_pages.h"

namespace remesh::cli {
namespace {

[[noreturn]] void fail(const std::string& path) { throw FileError(path + ": " + std::strerror(errno)); }

/// An open file that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int get() const { return fd_; }
  /// Closes the file. Some file systems report only here that the disk is full.
  /// Output: false if there was an error.
  bool close() {
    const int status = ::close(fd_);
    fd_ = -1;
    return status == 0;
  }

 private:
  int fd_;
};

/// Reads an open file from position `from` on into `bytes`, with all threads. One thread would copy a large file as
/// slowly as two threads make a mesh of it.
/// Output: the number of bytes up to the first gap. It is less than wanted if the file has become shorter.
std::size_t read_blocks(int fd, off_t from, std::span<char> bytes, const std::string& path, const RunControl& control) {
  constexpr std::size_t kBlock = std::size_t{1} << 21;
  std::vector<std::size_t> got((bytes.size() + kBlock - 1) / kBlock, 0);
  for_all(std::size_t{0}, got.size(), [&](std::size_t i) {
    const std::span<char> block = bytes.subspan(i * kBlock, std::min(kBlock, bytes.size() - i * kBlock));
    prefault_pages(block);
    while (got[i] < block.size()) {
      control.check();
      const std::span<char> rest = block.subspan(got[i]);
      const ssize_t more = ::pread(fd, rest.data(), rest.size(), from + static_cast<off_t>(i * kBlock + got[i]));
      if (more < 0 && errno == EINTR) continue;
      if (more < 0) fail(path);
      if (more == 0) return;
      got[i] += static_cast<std::size_t>(more);
    }
  });
  std::size_t all = 0;
  for (std::size_t i = 0; i < got.size() && all == i * kBlock; ++i) all += got[i];
  return all;
}

bool write_piece(int fd, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

using Pieces = std::span<const std::string_view>;

bool write_all(int fd, Pieces pieces) {
  return std::all_of(pieces.begin(), pieces.end(), [&](std::string_view piece) { return write_piece(fd, piece); });
}

/// The permissions that a new file of an ordinary program would get.
mode_t default_mode() {
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

/// The path that write_file replaces. A link stays a link, and the file that it points to is replaced.
std::filesystem::path replaced_by_writing(const std::string& path, bool exists) {
  std::error_code no_link;
  const std::filesystem::path target = exists ? std::filesystem::canonical(path, no_link) : std::filesystem::path(path);
  return no_link ? std::filesystem::path(path) : target;
}

void replace_file(const std::string& target, Pieces content, mode_t mode) {
  std::string temporary = target + ".XXXXXX";
  Descriptor file(::mkstemp(temporary.data()));
  if (file.get() < 0) fail(target);
  const bool is_written = write_all(file.get(), content) && ::fchmod(file.get(), mode) == 0 && file.close() &&
                          std::rename(temporary.c_str(), target.c_str()) == 0;
  if (is_written) return;
  const int error = errno;
  ::unlink(temporary.c_str());
  errno = error;
  fail(target);
}

void write_pieces(const std::string& path, Pieces content) {
  if (path == "-") {
    if (!write_all(STDOUT_FILENO, content)) fail("standard output");
    return;
  }
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && !S_ISREG(status.st_mode)) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (file.get() < 0 || !write_all(file.get(), content) || !file.close()) fail(path);
    return;
  }
  replace_file(replaced_by_writing(path, exists).string(), content, exists ? status.st_mode & 07777 : default_mode());
}

}  // namespace

/// Makes room for this many bytes, which are not initialised: filling the memory of a large file with zeros first
/// takes as long as reading the file.
void FileContent::reserve(std::size_t size) {
  if (size <= capacity_) return;
  std::unique_ptr<char[]> larger(new char[size]);
  std::copy_n(bytes_.get(), size_, larger.get());
  bytes_ = std::move(larger);
  capacity_ = size;
}

FileContent FileContent::read(int fd, const std::string& path, const RunControl& control) {
  constexpr std::size_t kChunk = std::size_t{1} << 20;
  struct stat status {};
  const bool has_size = ::fstat(fd, &status) == 0 && S_ISREG(status.st_mode);
  FileContent content;
  // This reserves one byte more than the file's size, so that the end is found without another chunk.
  if (has_size) content.reserve(static_cast<std::size_t>(status.st_size) + 1);
  if (const off_t from = has_size ? ::lseek(fd, 0, SEEK_CUR) : -1; from >= 0 && from < status.st_size) {
    const auto size = static_cast<std::size_t>(status.st_size - from);
    content.size_ = read_blocks(fd, from, {content.bytes_.get(), size}, path, control);
    if (::lseek(fd, from + static_cast<off_t>(content.size_), SEEK_SET) < 0) fail(path);
  }
  for (;;) {
    if (content.size_ == content.capacity_) content.reserve(std::max(kChunk, 2 * content.size_));
    const ssize_t got = ::read(fd, content.bytes_.get() + content.size_, content.capacity_ - content.size_);
    if (got < 0 && errno != EINTR) fail(path);
    control.check();
    if (got < 0) continue;
    if (got == 0) return content;
    content.size_ += static_cast<std::size_t>(got);
  }
}

FileContent read_file(const std::string& path, const RunControl& control) {
  if (path == "-") return FileContent::read(STDIN_FILENO, "standard input", control);
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  control.check();  // opening a pipe waits for its writer
  if (file.get() < 0) fail(path);
  return FileContent::read(file.get(), path, control);
}

void write_file(const std::string& path, std::string_view content) { write_pieces(path, {&content, 1}); }

void write_file(const std::string& path, std::span<const std::string> pieces) {
  write_pieces(path, std::vector<std::string_view>(pieces.begin(), pieces.end()));
}

void check_writable(const std::string& path) {
  if (path == "-") return;
  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) throw FileError(path + ": " + std::strerror(EISDIR));
  if (exists && !S_ISREG(status.st_mode)) {
    if (::access(path.c_str(), W_OK) != 0) fail(path);
    return;
  }
  // A new file will replace the old one, so the folder must be writable. The path "FILE/." does not exist if FILE is a
  // file.
  const std::filesystem::path folder = replaced_by_writing(path, exists).parent_path() / ".";
  if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(path);
}

Draft::Draft(const std::string& path) {
  struct stat status {};
  if (path == "-" || (::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode))) return;
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

Draft::~Draft() {
  if (fd_ >= 0) ::close(fd_);
}

void Draft::append(std::string_view text) {
  if (fd_ >= 0) (void)write_piece(fd_, text);
}

}  // namespace remesh::cli
