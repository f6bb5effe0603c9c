#include "tests/memory/counted_new.h"

#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace remesh::memory {
namespace {

std::atomic<void (*)(std::int64_t)> listener{nullptr};

void tell(std::int64_t bytes) {
  if (const auto told = listener.load(std::memory_order_relaxed)) told(bytes);
}

}  // namespace

void tell_allocations(void (*told)(std::int64_t bytes)) { listener = told; }

void* take(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  tell(static_cast<std::int64_t>(malloc_usable_size(memory)));
  return memory;
}

void give(void* memory) {
  if (memory == nullptr) return;
  tell(-static_cast<std::int64_t>(malloc_usable_size(memory)));
  std::free(memory);
}

}  // namespace remesh::memory

namespace counted = remesh::memory;

void* operator new(std::size_t bytes) { return counted::take(std::malloc(bytes > 0 ? bytes : 1)); }
void* operator new[](std::size_t bytes) { return operator new(bytes); }
void* operator new(std::size_t bytes, std::align_val_t align) {
  const auto a = static_cast<std::size_t>(align);
  return counted::take(std::aligned_alloc(a, (bytes + a - 1) / a * a));
}
void* operator new[](std::size_t bytes, std::align_val_t align) { return operator new(bytes, align); }
void operator delete(void* memory) noexcept { counted::give(memory); }
void operator delete[](void* memory) noexcept { counted::give(memory); }
void operator delete(void* memory, std::size_t) noexcept { counted::give(memory); }
void operator delete[](void* memory, std::size_t) noexcept { counted::give(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { counted::give(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { counted::give(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { counted::give(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { counted::give(memory); }
