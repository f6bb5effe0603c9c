#include "core/base/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <bit>
#include <new>

#include "core/base/error.h"

namespace remesh::parallel {
namespace {

/// Parts of at most so many items are sorted by one thread.
constexpr std::size_t kFewToSort = kItemsWorthThreads;

template <class Loop>
void run_loop(const Loop& loop) {
  tbb::this_task_arena::isolate(loop);
  if (tbb::is_current_task_group_canceling())
    throw Error(Code::kCancelled, Stage::kQueued, "another part of the work has failed");
}

/// Divides a part of a row, leaves what is above to another task, and goes on with what is below. After too many
/// divisions, which came out very unequal, one thread sorts the rest.
void sort_part(const SortSteps& steps, tbb::task_group& tasks, std::size_t begin, std::size_t end, int divisions) {
  while (end - begin > kFewToSort && divisions > 0) {
    --divisions;
    const auto [below_end, above_begin] = steps.divide(steps.row, begin, end);
    tasks.run([&steps, &tasks, from = above_begin, end, divisions] { sort_part(steps, tasks, from, end, divisions); });
    end = below_end;
  }
  steps.sort(steps.row, begin, end);
}

}  // namespace

void run_ranges(std::size_t begin, std::size_t end, std::size_t few,
                void (*call)(const void* body, std::size_t from, std::size_t to), const void* body) {
  run_loop([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, few),
                      [&](const auto& range) { call(body, range.begin(), range.end()); });
  });
}

void run_all_ranges(std::size_t end, std::size_t few, void (*call)(const void* body, std::size_t from, std::size_t to),
                    const void* body) noexcept {
  try {
    tbb::this_task_arena::isolate([&] {
      tbb::task_group_context own(tbb::task_group_context::isolated);
      tbb::parallel_for(
          tbb::blocked_range<std::size_t>(0, end, few),
          [&](const auto& range) { call(body, range.begin(), range.end()); }, own);
    });
  } catch (const std::bad_alloc&) {
  }
}

void run_sort(const SortSteps& steps, std::size_t n) {
  run_loop([&] {
    tbb::task_group tasks;
    tasks.run_and_wait([&] { sort_part(steps, tasks, 0, n, 2 * static_cast<int>(std::bit_width(n))); });
  });
}

}  // namespace remesh::parallel
