#include "server/http/spool.h"

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

#include "server/http/memory_files.h"
#include "server/observe/log.h"

namespace remesh::server {
namespace {

/// How often a reader that found no room tries again, while the slowest reader is being cut off.
constexpr std::chrono::milliseconds kLookAgain{20};

/// True if the file takes at most half of the free space. Other data, for example of jobs, needs space there, too.
bool has_disk_for(const std::string& folder, std::uint64_t bytes) {
  struct statvfs system {};
  return ::statvfs(folder.c_str(), &system) == 0 && bytes <= std::uint64_t{system.f_bavail} * system.f_frsize / 2;
}

bool write_all(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t put = ::write(file, bytes.data(), bytes.size());
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(put));
  }
  return true;
}

}  // namespace

Spool::Spool(std::string folder, std::uint64_t max_bytes, std::uint64_t max_held)
    : folder_(std::move(folder)),
      max_bytes_(max_bytes),
      max_held_(max_held),
      is_in_memory_(is_memory_folder(folder_)) {}

Spool::Reader::Reader(Spool& spool, Connection& connection) : spool_(spool), connection_(connection) {
  const std::lock_guard lock(spool_.mutex_);
  spool_.readers_.insert(this);
}

Spool::Reader::~Reader() {
  // Under the lock, the connection of a reader that is being cut off still exists.
  const std::lock_guard lock(spool_.mutex_);
  spool_.readers_.erase(this);
  if (fd_ >= 0) ::close(fd_);
  spool_.in_files_ -= in_file_;
  spool_.held_ -= held_;
}

double Spool::Reader::rate() const {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  return static_cast<double>(sent_) / std::max(seconds, 1e-3);
}

bool Spool::Reader::place(std::string_view rest) {
  for (;;) {
    if (spool_.reserve_file(rest.size())) {
      in_file_ = rest.size();
      fd_ = spool_.write_file(rest);
      if (fd_ >= 0) return true;
      spool_.in_files_ -= std::exchange(in_file_, 0);
    }
    if (spool_.reserve_memory(rest.size())) {
      held_ = rest.size();
      return false;
    }
    if (!spool_.cut_slowest(*this)) throw ConnectionLost("there is no room for an answer that is read so slowly");
    std::this_thread::sleep_for(kLookAgain);
  }
}

Spool::File::~File() {
  if (fd_ >= 0) spool_->release_file(fd_, size_);
}

std::string Spool::File::read(std::uint64_t begin, std::uint64_t end) const {
  std::string bytes(end - begin, '\0');
  for (std::size_t got = 0; got < bytes.size();) {
    const ssize_t more = ::pread(fd_, bytes.data() + got, bytes.size() - got, static_cast<off_t>(begin + got));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) throw std::runtime_error("a file of the spool cannot be read");
    got += static_cast<std::size_t>(more);
  }
  return bytes;
}

std::optional<Spool::File> Spool::keep(std::string_view bytes) {
  {
    const std::lock_guard lock(mutex_);
    if (in_files_ + bytes.size() > max_bytes_ / 2) return std::nullopt;
    in_files_ += bytes.size();
  }
  const int fd = write_file(bytes);
  if (fd >= 0) return File(*this, fd, bytes.size());
  release_file(fd, bytes.size());
  return std::nullopt;
}

void Spool::release_file(int fd, std::uint64_t bytes) {
  if (fd >= 0) ::close(fd);
  const std::lock_guard lock(mutex_);
  in_files_ -= bytes;
}

int Spool::write_file(std::string_view bytes) const {
  if (!has_disk_for(folder_, bytes.size())) return -1;
  const int file = ::open(folder_.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) return -1;
  if (write_all(file, bytes)) return file;
  ::close(file);
  return -1;
}

bool Spool::reserve_file(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  if (in_files_ + bytes > max_bytes_) return false;
  in_files_ += bytes;
  return true;
}

bool Spool::reserve_memory(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  if (held_ + bytes > max_held_) return false;
  held_ += bytes;
  return true;
}

bool Spool::cut_slowest(const Reader& reader) {
  const std::lock_guard lock(mutex_);
  // A reader that was cut off already is about to free its place.
  if (std::any_of(readers_.begin(), readers_.end(), [](const Reader* r) { return r->is_cut_; })) return true;
  Reader* const slowest = *std::min_element(readers_.begin(), readers_.end(),
                                            [](const Reader* a, const Reader* b) { return a->rate() < b->rate(); });
  log::write(log::Level::kWarning, "a slow reader was cut off", {{"bytes_per_second", slowest->rate()}});
  if (slowest == &reader) return false;
  slowest->is_cut_ = true;
  slowest->connection_.abort();
  return true;
}

}  // namespace remesh::server
