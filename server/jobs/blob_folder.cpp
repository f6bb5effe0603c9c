#include "server/jobs/blob_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "server/work/request_registry.h"

namespace remesh::server::jobs {
namespace {

[[noreturn]] void fail(const std::string& path) {
  const bool is_full = errno == ENOSPC || errno == EDQUOT;
  const std::string reason = path + ": " + std::strerror(errno);
  if (is_full) throw StoreFull(reason);
  throw StoreError(reason);
}

[[noreturn]] void lose(const std::string& path) { throw BlobLost(path + ": " + std::strerror(errno)); }

class Descriptor {
 public:
  Descriptor(const std::string& path, int flags) : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0600)) {
    if (fd_ < 0) fail(path);
  }
  ~Descriptor() { ::close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int operator*() const { return fd_; }

 private:
  int fd_;
};

void write_file(const std::string& path, std::string_view bytes) {
  const Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL);
  while (!bytes.empty()) {
    const ssize_t put = ::write(*file, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) fail(path);
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  if (::fsync(*file) != 0) fail(path);
}

void sync_folder(const std::string& path) {
  const Descriptor folder(path, O_RDONLY | O_DIRECTORY);
  if (::fsync(*folder) != 0) fail(path);
}

}  // namespace

BlobFolder::BlobFolder(std::string path) : path_(std::move(path)) {
  std::error_code failure;
  std::filesystem::create_directories(path_, failure);
  if (!std::filesystem::is_directory(path_, failure)) throw StoreError(path_ + ": this folder cannot be created");
  if (::access(path_.c_str(), W_OK | X_OK) != 0) fail(path_);
}

std::string BlobFolder::write(const std::string& id, std::string_view kind, std::string_view bytes) const {
  // The first two digits of the id choose the folder. A single folder would grow large; 256 folders stay small.
  const std::string folder = path_ + "/" + id.substr(0, 2);
  if (::mkdir(folder.c_str(), 0700) == 0) {
    sync_folder(path_);
  } else if (errno != EEXIST) {
    fail(folder);
  }
  // Two workers may finish the same job. Each writes its own file, and the database row of the accepted commit names
  // one of them.
  std::string name = id.substr(0, 2) + "/" + id + "." + new_request_id().substr(0, 8) + "." + std::string(kind);
  const std::string path = path_ + "/" + name;
  const std::string unfinished = path + ".part";
  try {
    write_file(unfinished, bytes);
    if (::rename(unfinished.c_str(), path.c_str()) != 0) fail(path);
    sync_folder(folder);
  } catch (const StoreError&) {
    ::unlink(unfinished.c_str());
    throw;
  }
  return name;
}

std::uint64_t BlobFolder::size(const std::string& name) const {
  const std::string path = path_ + "/" + name;
  struct stat status {};
  if (::stat(path.c_str(), &status) == 0) return static_cast<std::uint64_t>(status.st_size);
  // If the folder exists, the file is lost. If the folder is missing too, all files are missing, but only until the
  // folder is mounted again.
  if (errno == ENOENT && ::access(path_.c_str(), F_OK) == 0) lose(path);
  fail(path);
}

std::string BlobFolder::read(const std::string& name) const {
  const std::string path = path_ + "/" + name;
  std::string bytes(size(name), '\0');
  const Descriptor file(path, O_RDONLY);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(*file, bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) continue;
    if (got == 0) throw BlobLost(path + ": it ends early");
    if (got < 0 && errno == EIO) lose(path);
    if (got < 0) fail(path);
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

void BlobFolder::remove(const std::string& name) const noexcept {
  try {
    ::unlink((path_ + "/" + name).c_str());
  } catch (const std::bad_alloc&) {
  }
}

std::vector<BlobFolder::Found> BlobFolder::files_older_than(std::chrono::hours age, int part) const {
  constexpr std::string_view kDigits = "0123456789abcdef";
  const auto number = static_cast<std::size_t>(part);
  const std::string folder{kDigits[number / 16], kDigits[number % 16]};
  const auto last = std::filesystem::file_time_type::clock::now() - age;
  std::vector<Found> found;
  std::error_code failure;
  for (const auto& entry : std::filesystem::directory_iterator(path_ + "/" + folder, failure)) {
    const std::string name = entry.path().filename().string();
    const auto written = entry.last_write_time(failure);
    if (!failure && written < last)
      found.push_back({std::string(folder).append("/").append(name), name.substr(0, name.find('.'))});
  }
  return found;
}

}  // namespace remesh::server::jobs
