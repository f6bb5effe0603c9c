#include "tests/allocation/failing_new.h"

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace remesh::allocation {
namespace {

std::atomic<std::uint64_t> left{0};  ///< allocations up to the one that fails, itself included; 0: none will
std::atomic<bool> failed{false};
std::atomic<std::int64_t> alive{0};

thread_local bool is_spared = false;

bool is_to_fail() {
  if (is_spared) return false;
  std::uint64_t now = left.load();
  while (now > 0 && !left.compare_exchange_weak(now, now - 1)) {
  }
  if (now != 1) return false;
  failed = true;
  return true;
}

void* take(std::size_t size, std::size_t alignment) noexcept {
  if (is_to_fail()) return nullptr;
  void* memory = nullptr;
  if (alignment <= alignof(std::max_align_t)) {
    memory = std::malloc(size == 0 ? 1 : size);
  } else {
    memory = std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
  }
  if (memory != nullptr) ++alive;
  return memory;
}

void* take_or_throw(std::size_t size, std::size_t alignment) {
  void* memory = take(size, alignment);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void give(void* memory) noexcept {
  if (memory != nullptr) --alive;
  std::free(memory);
}

constexpr std::size_t kPlain = alignof(std::max_align_t);

}  // namespace

void fail_at(std::uint64_t n) {
  failed = false;
  left = n;
}
void spare_this_thread() { is_spared = true; }
bool has_failed() { return failed; }
std::int64_t live() { return alive; }

}  // namespace remesh::allocation

namespace ra = remesh::allocation;

void* operator new(std::size_t size) { return ra::take_or_throw(size, ra::kPlain); }
void* operator new[](std::size_t size) { return ra::take_or_throw(size, ra::kPlain); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return ra::take(size, ra::kPlain); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return ra::take(size, ra::kPlain); }
void* operator new(std::size_t size, std::align_val_t at) {
  return ra::take_or_throw(size, static_cast<std::size_t>(at));
}
void* operator new[](std::size_t size, std::align_val_t at) {
  return ra::take_or_throw(size, static_cast<std::size_t>(at));
}
void operator delete(void* memory) noexcept { ra::give(memory); }
void operator delete[](void* memory) noexcept { ra::give(memory); }
void operator delete(void* memory, std::size_t) noexcept { ra::give(memory); }
void operator delete[](void* memory, std::size_t) noexcept { ra::give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { ra::give(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { ra::give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { ra::give(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { ra::give(memory); }
