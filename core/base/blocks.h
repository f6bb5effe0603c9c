/// Parallel loops whose results do not depend on the number of threads.
#pragma once

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/parallel.h"
#include "core/base/run_control.h"

namespace remesh {

/// Block size for work that costs a few nanoseconds per item. It is large enough to be worth a task, and small enough
/// that a cancellation is noticed soon.
inline constexpr std::size_t kItemsPerBlock = 8192;

/// Splits [0, n) into blocks of `size`, calls `body(begin, end)` on each in parallel, and returns the results in the
/// order of the blocks. The blocks depend on n alone, so a caller that combines the results in order gets the same bits
/// from any number of threads. Checks for cancellation before each block.
template <class Result, class Body>
std::vector<Result> map_blocks(std::size_t n, std::size_t size, RunControl& control, const Body& body) {
  std::vector<Result> results((n + size - 1) / size);
  if (results.size() == 1) {
    control.check();
    results[0] = body(std::size_t{0}, n);
    return results;
  }
  for_all(0, results.size(), [&](std::size_t block) {
    control.check_and_move();
    results[block] = body(block * size, std::min(n, (block + 1) * size));
  });
  return results;
}

/// Does the same for a body that stores its results itself, by index.
template <class Body>
void for_blocks(std::size_t n, std::size_t size, RunControl& control, const Body& body) {
  if (n <= size) {
    control.check();
    if (n > 0) body(std::size_t{0}, n);
    return;
  }
  for_all(0, (n + size - 1) / size, [&](std::size_t block) {
    control.check_and_move();
    body(block * size, std::min(n, (block + 1) * size));
  });
}

/// Returns those ids i of 0 .. n - 1 for which `is_wanted(i)` is true, in ascending order. Calls `is_wanted` in
/// parallel.
/// Errors: kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
template <class Id, class IsWanted>
std::vector<Id> select_ids(std::size_t n, std::size_t size, RunControl& control, const IsWanted& is_wanted) {
  const auto found = map_blocks<std::vector<Id>>(n, size, control, [&](std::size_t begin, std::size_t end) {
    std::vector<Id> wanted;
    for (std::size_t i = begin; i < end; ++i)
      if (is_wanted(i)) wanted.push_back(Id(i));
    return wanted;
  });
  std::size_t count = 0;
  for (const std::vector<Id>& wanted : found) count += wanted.size();
  control.memory().ask_for<Id>(count);
  std::vector<Id> all;
  all.reserve(count);
  for (const std::vector<Id>& wanted : found) all.insert(all.end(), wanted.begin(), wanted.end());
  return all;
}

/// Joins the items of all blocks in the order of the blocks, and passes each item through `convert`. Runs in parallel.
/// Errors: as above.
template <class To, class From, class Convert = std::identity>
std::vector<To, DefaultInit<To>> concatenate(const std::vector<std::vector<From>>& blocks, RunControl& control,
                                             const Convert& convert = {}) {
  std::vector<std::size_t> begin(blocks.size() + 1, 0);
  for (std::size_t b = 0; b < blocks.size(); ++b) begin[b + 1] = begin[b] + blocks[b].size();
  control.memory().ask_for<To>(begin.back());
  std::vector<To, DefaultInit<To>> all(begin.back());
  for_blocks(blocks.size(), 16, control, [&](std::size_t b, std::size_t end) {
    for (; b < end; ++b)
      std::transform(blocks[b].begin(), blocks[b].end(), all.begin() + static_cast<std::ptrdiff_t>(begin[b]), convert);
  });
  return all;
}

/// Calls `make(i)` for i from 0 to n - 1 in parallel. Calls `take(i, result)` on the results in ascending order, one at
/// a time. Only a few results exist at once. Checks for cancellation before each call of `make`.
/// Output: false if some call of `take` returned false. Then `take` is not called again, and `make` soon is not either.
template <class Result, class Make, class Take>
bool map_in_order(std::size_t n, RunControl& control, const Make& make, const Take& take) {
  if (n == 1) {
    control.check();
    return take(std::size_t{0}, make(std::size_t{0}));
  }
  using Item = std::pair<std::size_t, Result>;
  constexpr std::size_t kResultsPerThread = 4;
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  std::size_t next = 0;
  std::atomic<bool> is_stopped = false;
  const auto count = [&](tbb::flow_control& flow) {
    if (next == n || is_stopped) flow.stop();
    return next++;
  };
  const auto make_item = [&](std::size_t i) {
    control.check();
    return is_stopped ? Item(i, Result()) : Item(i, make(i));
  };
  const auto take_item = [&](Item item) {
    if (!is_stopped && !take(item.first, std::move(item.second))) is_stopped = true;
  };
  tbb::parallel_pipeline(kResultsPerThread * threads,
                         tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, count) &
                             tbb::make_filter<std::size_t, Item>(tbb::filter_mode::parallel, make_item) &
                             tbb::make_filter<Item, void>(tbb::filter_mode::serial_in_order, take_item));
  return !is_stopped;
}

}  // namespace remesh
