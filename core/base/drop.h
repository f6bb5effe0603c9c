/// The end of what is made of a million parts.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <cstddef>
#include <new>
#include <utility>
#include <vector>

namespace remesh {

/// Empties a vector whose items have memory of their own, in parallel: to free that of a million patches takes a tenth
/// of a second, and somebody who has stopped the work waits for it.
/// Holds:  nothing is thrown. It is done in parallel even where the caller's group of tasks has been cancelled, but not
///         where there is no memory for tasks.
template <class T>
void drop_all(std::vector<T>& items) noexcept {
  constexpr std::size_t kFew = 1 << 12;
  const auto drop_in_parallel = [&] {
    tbb::task_group_context own(tbb::task_group_context::isolated);
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, items.size(), kFew),
        [&](const auto& range) {
          for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const T gone = std::move(items[i]);
          }
        },
        own);
  };
  try {
    if (items.size() > kFew) tbb::this_task_arena::isolate(drop_in_parallel);
  } catch (const std::bad_alloc&) {
    // What is left ends with the vector.
  }
  std::vector<T>().swap(items);
}

/// A vector that ends with drop_all.
template <class T>
struct Dropped {
  Dropped() = default;
  ~Dropped() { drop_all(items); }
  Dropped(const Dropped&) = delete;
  Dropped& operator=(const Dropped&) = delete;

  std::vector<T> items;
};

}  // namespace remesh
