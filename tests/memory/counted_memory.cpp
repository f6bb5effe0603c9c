#include "tests/memory/counted_memory.h"

#include <atomic>
#include <cstddef>
#include <mutex>

#include "tests/memory/counted_new.h"

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

}  // namespace

CountedMemory::CountedMemory(const RunControl& control) {
  held = 0;
  stages = {};
  for (auto& share : shares) share = 0;
  watched = &control;
  tell_allocations(count);
}
CountedMemory::~CountedMemory() { tell_allocations(nullptr); }
StagePeaks CountedMemory::peaks() const {
  const std::lock_guard lock(mutex);
  return stages;
}

}  // namespace remesh::memory
