#include "server/http/memory_files.h"

#include <linux/magic.h>
#include <sys/vfs.h>

#include <algorithm>
#include <atomic>

namespace remesh::server {
namespace {

bool is_memory(const struct statfs& system) { return system.f_type == TMPFS_MAGIC || system.f_type == RAMFS_MAGIC; }

std::atomic<std::int64_t> unmapped_bytes{0};

}  // namespace

bool is_memory_folder(const std::string& folder) {
  struct statfs system {};
  return ::statfs(folder.c_str(), &system) == 0 && is_memory(system);
}

bool is_memory_file(int file) {
  struct statfs system {};
  return ::fstatfs(file, &system) == 0 && is_memory(system);
}

std::uint64_t memory_file_bytes() {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(0, unmapped_bytes.load()));
}

void add_memory_file_bytes(std::int64_t bytes) { unmapped_bytes += bytes; }

}  // namespace remesh::server
