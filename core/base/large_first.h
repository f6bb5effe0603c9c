/// An order for parallel work: large items go first, so that no thread still works on a large item at the end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/parallel.h"
#include "core/base/run_control.h"

namespace remesh {

struct LargeFirst {
  std::vector<std::uint32_t> order;  ///< all items, the large ones first
  std::size_t large = 0;             ///< the number of large items; each of them is worth a task of its own
};

/// Orders 0 .. n-1. Items with work(i) above `limit` come first, in descending order of work and, where that is equal,
/// by number. The other items follow by number.
template <class Work>
LargeFirst large_first(std::size_t n, std::size_t limit, const Work& work) {
  struct Item {
    std::size_t work;
    std::uint32_t number;
  };
  std::vector<Item> large;
  LargeFirst result;
  result.order.reserve(n);
  std::vector<std::uint32_t> small;
  small.reserve(n);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::size_t of_this = work(i);
    if (of_this > limit)
      large.push_back({of_this, i});
    else
      small.push_back(i);
  }
  std::sort(large.begin(), large.end(),
            [](const Item& a, const Item& b) { return a.work != b.work ? a.work > b.work : a.number < b.number; });
  for (const Item& item : large) result.order.push_back(item.number);
  result.order.insert(result.order.end(), small.begin(), small.end());
  result.large = large.size();
  return result;
}

/// Calls `body(i)` for 0 .. n-1 in parallel. Each item with work(i) above `limit` is a task of its own, and several
/// smaller items share a task. Checks for cancellation before each task.
template <class Work, class Body>
void for_large_first(std::size_t n, std::size_t limit, const Work& work, RunControl& control, const Body& body) {
  const LargeFirst by_work = large_first(n, limit, work);
  for_all(0, by_work.large, [&](std::size_t i) {
    control.check();
    body(by_work.order[i]);
  });
  constexpr std::size_t kGroup = 64;
  for_blocks(n - by_work.large, kGroup, control, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(by_work.order[by_work.large + i]);
  });
}

}  // namespace remesh
