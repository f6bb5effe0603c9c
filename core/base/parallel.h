/// TBB's loops, in a form that may be nested.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/error.h"

namespace remesh {

/// Runs a loop of TBB. A plain TBB loop inside a task of another loop has two surprising properties:
/// - When a task has thrown, the inner loops of all other tasks end at once, with their work undone, and return as if
///   it were done. In that case this function throws, so that no result is made of undone work. The outer loop then
///   throws the first exception.
/// - A thread that waits for an inner loop takes any task there is, so outer tasks would pile up on its stack. Here it
///   takes only tasks of the inner loop.
template <class Loop>
void run_loop(const Loop& loop) {
  tbb::this_task_arena::isolate(loop);
  if (tbb::is_current_task_group_canceling())
    throw Error(Code::kCancelled, Stage::kQueued, "another part of the work has failed");
}

/// Runs tbb::parallel_for.
template <class... Arguments>
void for_all(Arguments&&... arguments) {
  run_loop([&] { tbb::parallel_for(std::forward<Arguments>(arguments)...); });
}

/// Work on fewer items is not worth waking a thread.
inline constexpr int kItemsWorthThreads = 500;

/// Runs tbb::parallel_sort, or std::sort if there are few items.
template <class Iterator, class... Less>
void sort_all(Iterator begin, Iterator end, const Less&... less) {
  if (end - begin < kItemsWorthThreads) return std::sort(begin, end, less...);
  run_loop([&] { tbb::parallel_sort(begin, end, less...); });
}

/// Runs tbb::parallel_invoke, or one part after the other if they work on few items.
template <class... Parts>
void do_all(std::size_t items, const Parts&... parts) {
  if (items < kItemsWorthThreads) return (parts(), ...);
  run_loop([&] { tbb::parallel_invoke(parts...); });
}

}  // namespace remesh
