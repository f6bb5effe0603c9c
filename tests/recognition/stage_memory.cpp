#include "tests/recognition/stage_memory.h"

#include <atomic>

#include "tests/memory/counted_new.h"

namespace remesh::recognition {
namespace {

std::atomic<const RunControl*> watched{nullptr};
std::atomic<Stage> watched_stage{Stage::kQueued};
std::atomic<std::int64_t> now{0};
std::atomic<std::int64_t> most{0};

void count(std::int64_t bytes) {
  const RunControl* control = watched.load(std::memory_order_relaxed);
  if (control->stage() != watched_stage.load(std::memory_order_relaxed)) return;
  const std::int64_t sum = now.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  std::int64_t largest = most.load(std::memory_order_relaxed);
  while (sum > largest && !most.compare_exchange_weak(largest, sum, std::memory_order_relaxed)) {
  }
}

}  // namespace

StageMemory::StageMemory(const RunControl& control, Stage stage) {
  now = 0;
  most = 0;
  watched_stage = stage;
  watched = &control;
  memory::tell_allocations(count);
}
StageMemory::~StageMemory() { memory::tell_allocations(nullptr); }
std::int64_t StageMemory::most_bytes() const { return most; }

}  // namespace remesh::recognition
