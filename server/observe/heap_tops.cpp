#include "server/observe/heap_tops.h"

#include <malloc.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <mutex>

namespace remesh::server {
namespace {

/// Blocks of this size have memory of their own, which is returned when they are freed.
constexpr int kOwnMemory = 32 << 20;
/// While a request is computed, a heap is trimmed only if more than this is free at its end. If it were trimmed more
/// often, the same memory would be requested again and again, and the system would clear each page each time.
constexpr int kUsualThreshold = 64 << 20;
constexpr int kLowThreshold = 1 << 20;
/// The allocator checks the end of a heap when a block is freed that is at least half as large as this.
constexpr std::size_t kLargeBlock = 128 << 10;

std::atomic<std::uint64_t> asked{0};
thread_local std::uint64_t answered = 0;

}  // namespace

void HeapTops::set_thresholds() {
  ::mallopt(M_MMAP_THRESHOLD, kOwnMemory);
  ::mallopt(M_TRIM_THRESHOLD, kUsualThreshold);
}

void HeapTops::ask() { ++asked; }

bool HeapTops::is_asked() { return answered != asked; }

void HeapTops::return_now() {
  answered = asked;
  // The threshold holds for all threads. Another thread that frees a block at this moment returns its memory as well.
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  ::mallopt(M_TRIM_THRESHOLD, kLowThreshold);
  void* volatile block = std::malloc(kLargeBlock);  // volatile, so that the compiler does not leave it out
  std::free(block);
  ::mallopt(M_TRIM_THRESHOLD, kUsualThreshold);
}

}  // namespace remesh::server
