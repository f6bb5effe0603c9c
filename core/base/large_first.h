/// An order for parallel work: what is large goes first, so that none of it is left for the end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace remesh {

struct LargeFirst {
  std::vector<std::uint32_t> order;  ///< all items
  std::size_t large = 0;             ///< so many of them, at the beginning, are worth a task each
};

/// 0 .. n-1: those with more than `limit` work(i) first, the most work before the others and equals by number; then the
/// rest, by number.
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

}  // namespace remesh
