#include "server/http/body.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "server/http/http_message.h"
#include "server/http/memory_files.h"

namespace remesh::server {
namespace {

[[noreturn]] void no_room() {
  throw HttpError(503, "out_of_memory", "the server has no room for this body at the moment: try again shortly");
}

/// Opens a file that disappears when its descriptor is closed. It is in the temporary folder or, if no file can be
/// written there, in memory.
int open_file() {
  std::error_code none;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(none);
  int file = none ? -1 : ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) file = ::memfd_create("body", MFD_CLOEXEC);
  if (file < 0) no_room();
  return file;
}

}  // namespace

Body::~Body() {
  unmap();
  record_unmapped(0);
  if (file_ >= 0) ::close(file_);
}

void Body::swap(Body& other) noexcept {
  std::swap(size_, other.size_);
  text_.swap(other.text_);
  std::swap(file_, other.file_);
  std::swap(is_in_memory_, other.is_in_memory_);
  std::swap(unmapped_, other.unmapped_);
  std::swap(mapped_, other.mapped_);
}

void Body::append(std::string_view bytes) {
  if (file_ < 0 && size_ + bytes.size() > kInMemory) {
    file_ = open_file();
    is_in_memory_ = is_memory_file(file_);
    write_to_file(text_);
    std::string().swap(text_);
  }
  size_ += bytes.size();
  if (file_ < 0) {
    text_.append(bytes);
  } else {
    write_to_file(bytes);
  }
}

void Body::write_to_file(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(file_, bytes.data(), bytes.size());
    if (put >= 0) {
      record_unmapped(unmapped_ + static_cast<std::uint64_t>(put));
      bytes.remove_prefix(static_cast<std::size_t>(put));
    } else if (errno != EINTR) {
      no_room();
    }
  }
}

void Body::record_unmapped(std::uint64_t bytes) {
  if (!is_in_memory_) return;
  add_memory_file_bytes(static_cast<std::int64_t>(bytes) - static_cast<std::int64_t>(unmapped_));
  unmapped_ = bytes;
}

void Body::rest() { unmap(); }

void Body::unmap() {
  if (mapped_ == nullptr) return;
  ::munmap(const_cast<char*>(mapped_), size_);
  mapped_ = nullptr;
  record_unmapped(size_);
}

void Body::seal() {
  if (file_ < 0 || mapped_ != nullptr) return;
  void* const mapped = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, file_, 0);
  if (mapped == MAP_FAILED) no_room();
  mapped_ = static_cast<const char*>(mapped);
  record_unmapped(0);
}

}  // namespace remesh::server
