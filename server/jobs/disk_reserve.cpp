#include "server/jobs/disk_reserve.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>

#include "server/http/units.h"
#include "server/jobs/job_store.h"

namespace remesh::server::jobs {
namespace {

constexpr std::uint64_t kMaxReserve = 8 << 20;
constexpr std::uint64_t kShare = 20;  ///< the reserve is at most this part of the volume
constexpr std::uint64_t kParts = 4;   ///< so many times some of it can be released
constexpr std::uint64_t kLeast = 64 << 10;

std::uint64_t size_of(const std::string& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

}  // namespace

DiskReserve::Room DiskReserve::room() const {
  struct statvfs volume {};
  // If the system does not report the free space, there is no limit: then writing shows whether there is room.
  if (::statvfs(folder_.c_str(), &volume) != 0) return {~std::uint64_t{0} / 2, 0};
  const std::uint64_t block = volume.f_frsize;
  return {volume.f_bavail * block, std::min(kMaxReserve, volume.f_blocks * block / kShare)};
}

void DiskReserve::keep() const noexcept {
  const Room now = room();
  const std::uint64_t size = size_of(path_);
  if (size >= now.reserve) return;
  const std::uint64_t more = std::min(now.reserve - size, now.free);
  if (more < std::min(kLeast, now.reserve - size)) return;
  const int file = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file < 0) return;
  if (::posix_fallocate(file, static_cast<off_t>(size), static_cast<off_t>(more)) != 0 &&
      ::ftruncate(file, static_cast<off_t>(size)) != 0)
    ::unlink(path_.c_str());
  ::close(file);
}

bool DiskReserve::release() const noexcept {
  const std::uint64_t size = size_of(path_), part = std::max(kLeast, room().reserve / kParts);
  if (size > part) return ::truncate(path_.c_str(), static_cast<off_t>(size - part)) == 0;
  return ::unlink(path_.c_str()) == 0 && size > 0;
}

void DiskReserve::check_room(std::uint64_t bytes, RoomFor purpose) const {
  const Room now = room();
  // Storing a result ends a job and removes its input, so it may use all room except the reserve.
  const std::uint64_t for_deletions = now.reserve - std::min(now.reserve, size_of(path_));
  const std::uint64_t stays = purpose == RoomFor::kNewJob ? 2 * now.reserve : for_deletions;
  if (now.free >= stays && now.free - stays >= bytes) return;
  throw RoomRefused("the volume of " + folder_ + " has " + format_bytes(now.free) + " left");
}

bool DiskReserve::is_scarce() const {
  const Room now = room();
  return now.free < 8 * now.reserve;
}

}  // namespace remesh::server::jobs
