/// Asks the system in advance for the pages of memory that is about to be written.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"

namespace remesh {

/// Asks the system for all pages of a block of memory at once, which is faster than to get each page at its first
/// access. The whole block should be about to be written. Does nothing for little memory, or if the system does not
/// support it. See experiments.md, Memory pages.
void prefault_pages(void* memory, std::size_t bytes);

template <class T>
void prefault_pages(std::span<T> items) {
  prefault_pages(items.data(), items.size_bytes());
}

/// Reserves memory for `n` items that one thread will make. All threads take its pages.
/// Errors: kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
template <class T>
void reserve_pages(std::vector<T>& items, std::size_t n, RunControl& control) {
  control.memory().ask_for<T>(n);
  items.reserve(n);
  auto* const memory = reinterpret_cast<std::byte*>(items.data());
  for_blocks(n * sizeof(T), std::size_t{1} << 20, control,
             [&](std::size_t begin, std::size_t end) { prefault_pages(memory + begin, end - begin); });
}

}  // namespace remesh
