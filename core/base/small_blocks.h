/// Memory for an object that has many vectors, most of them short.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <new>

namespace remesh {

/// Small blocks are cut from a few larger ones, and given back with these when the resource goes: of a thousand small
/// objects, allocating is most of the work. Large blocks come from the heap and go back to it at once, so that an
/// object that grows keeps no more than it needs. Not for several threads at once.
class SmallBlocks : public std::pmr::memory_resource {
 public:
  /// `first`: bytes of the first of the larger blocks.
  explicit SmallBlocks(std::size_t first) : small_(first, &heap_) {}

 private:
  /// As `operator new` has it: the standard's resource asks for an alignment, which takes it longer.
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

/// For the short vectors of one call: on the stack, as far as that suffices.
class StackMemory : public std::pmr::monotonic_buffer_resource {
 public:
  StackMemory() : monotonic_buffer_resource(bytes_, sizeof bytes_) {}

 private:
  alignas(std::max_align_t) std::byte bytes_[2048];
};

}  // namespace remesh
