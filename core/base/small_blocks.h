/// Memory for an object that has many vectors, most of them short.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <new>

namespace remesh {

/// Cuts small blocks from a few larger ones, and frees all of them when the resource is destroyed. With a thousand
/// small objects, allocation would otherwise take most of the time. Large blocks come from the heap and return to it at
/// once, so that a growing object uses no more memory than it needs. It must not be used by several threads at once.
class SmallBlocks : public std::pmr::memory_resource {
 public:
  /// `first`: the size in bytes of the first of the larger blocks.
  explicit SmallBlocks(std::size_t first) : small_(first, &heap_) {}

 private:
  /// Calls plain `operator new`. The standard's resource passes an alignment, which makes it slower.
  class Heap : public std::pmr::memory_resource {
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
      if (alignment > __STDCPP_DEFAULT_NEW_ALIGNMENT__) throw std::bad_alloc();
      return ::operator new(bytes);
    }
    void do_deallocate(void* at, std::size_t, std::size_t) override { ::operator delete(at); }
    bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
  };

  static constexpr std::size_t kLarge = 1024;

  memory_resource& source(std::size_t bytes) {
    if (bytes < kLarge) return small_;
    return heap_;
  }
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    return source(bytes).allocate(bytes, alignment);
  }
  void do_deallocate(void* at, std::size_t bytes, std::size_t alignment) override {
    source(bytes).deallocate(at, bytes, alignment);
  }
  bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }

  Heap heap_;
  std::pmr::monotonic_buffer_resource small_;
};

/// Memory for the short vectors of one call. It comes from the stack as long as that suffices, and then from the heap.
class StackMemory : public std::pmr::monotonic_buffer_resource {
 public:
  StackMemory() : monotonic_buffer_resource(bytes_, sizeof bytes_) {}

 private:
  alignas(std::max_align_t) std::byte bytes_[2048];
};

}  // namespace remesh
