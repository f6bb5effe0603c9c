/// Frees objects that consist of a million parts, in parallel.
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

/// Empties a vector whose items own memory, in parallel. Freeing the memory of a million patches takes a tenth of a
/// second, which a cancelled run would still have to wait for.
/// Holds:  nothing is thrown. The work is parallel even if the caller's group of tasks has been cancelled, but not if
///         there is no memory for tasks.
template <class T>
void free_in_parallel(std::vector<T>& items) noexcept {
  constexpr std::size_t kFew = 1 << 12;
  const auto free_blocks = [&] {
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
    if (items.size() > kFew) tbb::this_task_arena::isolate(free_blocks);
  } catch (const std::bad_alloc&) {
    // The items that are left are freed with the vector.
  }
  std::vector<T>().swap(items);
}

/// A vector that is emptied by free_in_parallel when it goes out of scope.
template <class T>
struct FreedInParallel {
  FreedInParallel() = default;
  ~FreedInParallel() { free_in_parallel(items); }
  FreedInParallel(const FreedInParallel&) = delete;
  FreedInParallel& operator=(const FreedInParallel&) = delete;

  std::vector<T> items;
};

}  // namespace remesh
