/// Memory that is about to be written to.
#pragma once

#include <cstddef>
#include <span>

namespace remesh {

/// Takes the pages of memory from the system that is about to be written to as a whole, all of them at once: one by
/// one, as each is touched first, they take half as long again. Does nothing for little memory, nor where the system
/// does not know how.
void take_pages(void* memory, std::size_t bytes);

template <class T>
void take_pages(std::span<T> items) {
  take_pages(items.data(), items.size_bytes());
}

}  // namespace remesh
