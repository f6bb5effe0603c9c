/// Memory that is about to be written to.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/run_control.h"

namespace remesh {

/// Takes the pages of memory from the system that is about to be written to as a whole, all of them at once: one by
/// one, as each is touched first, they take half as long again. Does nothing for little memory, nor where the system
/// does not know how.
void take_pages(void* memory, std::size_t bytes);

template <class T>
void take_pages(std::span<T> items) {
  take_pages(items.data(), items.size_bytes());
}

/// Reserves memory for `n` items that one thread will make: all threads take its pages.
template <class T>
void reserve_pages(std::vector<T>& items, std::size_t n, RunControl& control) {
  items.reserve(n);
  auto* const memory = reinterpret_cast<std::byte*>(items.data());
  for_blocks(n * sizeof(T), std::size_t{1} << 20, control,
             [&](std::size_t begin, std::size_t end) { take_pages(memory + begin, end - begin); });
}

}  // namespace remesh
