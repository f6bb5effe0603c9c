#include "tests/recognition/stage_memory.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace remesh::recognition {
namespace {

std::atomic<const RunControl*> watched{nullptr};
std::atomic<Stage> watched_stage{Stage::kQueued};
std::atomic<std::int64_t> now{0};
std::atomic<std::int64_t> most{0};

void count(std::int64_t bytes) {
  const RunControl* control = watched.load(std::memory_order_relaxed);
  if (control == nullptr || control->stage() != watched_stage.load(std::memory_order_relaxed)) return;
  const std::int64_t sum = now.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  std::int64_t largest = most.load(std::memory_order_relaxed);
  while (sum > largest && !most.compare_exchange_weak(largest, sum, std::memory_order_relaxed)) {
  }
}

void* allocated(void* p) {
  if (p == nullptr) throw std::bad_alloc();
  count(static_cast<std::int64_t>(malloc_usable_size(p)));
  return p;
}

void release(void* p) {
  if (p == nullptr) return;
  count(-static_cast<std::int64_t>(malloc_usable_size(p)));
  std::free(p);
}

}  // namespace

StageMemory::StageMemory(const RunControl& control, Stage stage) {
  now = 0;
  most = 0;
  watched_stage = stage;
  watched = &control;
}
StageMemory::~StageMemory() { watched = nullptr; }
std::int64_t StageMemory::most_bytes() const { return most; }

}  // namespace remesh::recognition

void* operator new(std::size_t bytes) { return remesh::recognition::allocated(std::malloc(bytes > 0 ? bytes : 1)); }
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void* operator new(std::size_t bytes, std::align_val_t align) {
  const auto a = static_cast<std::size_t>(align);
  return remesh::recognition::allocated(std::aligned_alloc(a, (bytes + a - 1) / a * a));
}
void* operator new[](std::size_t bytes, std::align_val_t align) { return operator new(bytes, align); }
void operator delete(void* p) noexcept { remesh::recognition::release(p); }
void operator delete[](void* p) noexcept { remesh::recognition::release(p); }
void operator delete(void* p, std::size_t) noexcept { remesh::recognition::release(p); }
void operator delete[](void* p, std::size_t) noexcept { remesh::recognition::release(p); }
void operator delete(void* p, std::align_val_t) noexcept { remesh::recognition::release(p); }
void operator delete[](void* p, std::align_val_t) noexcept { remesh::recognition::release(p); }
void operator delete(void* p, std::size_t, std::align_val_t) noexcept { remesh::recognition::release(p); }
void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { remesh::recognition::release(p); }
