#include "tests/memory/counted_memory.h"

#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <new>

namespace remesh::memory {
namespace {

std::atomic<const RunControl*> watched{nullptr};
std::atomic<std::int64_t> held{0};
std::mutex mutex;  ///< it guards the peaks
StagePeaks stages;
/// The share of each stage that was reached before. Most allocations stay below it and need no lock.
std::array<std::atomic<double>, kStageCount> shares;

void count(std::int64_t bytes) {
  const RunControl* control = watched.load(std::memory_order_relaxed);
  if (control == nullptr) return;
  const std::int64_t now = held.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  const std::uint64_t allowed = control->memory().allowed();
  if (bytes < 0 || now < 0 || allowed == MemoryBound::kNone) return;
  const StagePeak peak{static_cast<std::uint64_t>(now), allowed};
  const auto stage = static_cast<std::size_t>(control->stage());
  if (peak.share() <= shares[stage].load(std::memory_order_relaxed)) return;
  const std::lock_guard lock(mutex);
  if (peak.share() <= stages[stage].share()) return;
  stages[stage] = peak;
  shares[stage] = peak.share();
}

void* take(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  count(static_cast<std::int64_t>(malloc_usable_size(memory)));
  return memory;
}

void give(void* memory) {
  if (memory == nullptr) return;
  count(-static_cast<std::int64_t>(malloc_usable_size(memory)));
  std::free(memory);
}

}  // namespace

CountedMemory::CountedMemory(const RunControl& control) {
  held = 0;
  stages = {};
  for (auto& share : shares) share = 0;
  watched = &control;
}
CountedMemory::~CountedMemory() { watched = nullptr; }
StagePeaks CountedMemory::peaks() const {
  const std::lock_guard lock(mutex);
  return stages;
}

}  // namespace remesh::memory

namespace rm = remesh::memory;

void* operator new(std::size_t bytes) { return rm::take(std::malloc(bytes > 0 ? bytes : 1)); }
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void* operator new(std::size_t bytes, std::align_val_t align) {
  const auto a = static_cast<std::size_t>(align);
  return rm::take(std::aligned_alloc(a, (bytes + a - 1) / a * a));
}
void* operator new[](std::size_t bytes, std::align_val_t align) { return operator new(bytes, align); }
void operator delete(void* memory) noexcept { rm::give(memory); }
void operator delete[](void* memory) noexcept { rm::give(memory); }
void operator delete(void* memory, std::size_t) noexcept { rm::give(memory); }
void operator delete[](void* memory, std::size_t) noexcept { rm::give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { rm::give(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { rm::give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { rm::give(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { rm::give(memory); }
