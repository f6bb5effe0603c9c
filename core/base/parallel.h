/// TBB's loops in the form that may stand inside one another.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_sort.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <utility>

#include "core/base/error.h"

namespace remesh {

/// Runs a loop of TBB's. Two things are not as one expects of a plain one in a task of another loop:
/// - Where a task has thrown, all others' inner loops end at once, their work undone, and return as if it were done.
///   This throws then, for no result to be made of it; the outer loop throws what came first.
/// - A thread that waits for an inner loop takes any task there is, so that outer ones would pile up on its stack. Here
///   it waits for the inner loop's own.
template <class Loop>
void run_loop(const Loop& loop) {
  tbb::this_task_arena::isolate(loop);
  if (tbb::is_current_task_group_canceling())
    throw Error(Code::kCancelled, Stage::kQueued, "another part of the work has failed");
}

/// tbb::parallel_for.
template <class... Arguments>
void for_all(Arguments&&... arguments) {
  run_loop([&] { tbb::parallel_for(std::forward<Arguments>(arguments)...); });
}

/// tbb::parallel_sort.
template <class Iterator, class... Less>
void sort_all(Iterator begin, Iterator end, const Less&... less) {
  constexpr int kFew = 500;
  if (end - begin < kFew) return std::sort(begin, end, less...);
  run_loop([&] { tbb::parallel_sort(begin, end, less...); });
}

/// tbb::parallel_invoke.
template <class... Parts>
void do_all(const Parts&... parts) {
  run_loop([&] { tbb::parallel_invoke(parts...); });
}

}  // namespace remesh
