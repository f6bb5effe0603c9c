/// Groups items by small integer keys, in parallel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/blocks.h"
#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/stoppable.h"

namespace remesh {

/// The numbers 0 .. n-1, grouped by their keys.
template <class Item>
struct GroupingOf {
  std::vector<std::uint32_t> begin;            ///< where each key's items begin; one entry more than there are keys
  std::vector<Item, DefaultInit<Item>> items;  ///< ascending in each group

  std::span<const Item> operator[](std::size_t key) const {
    return std::span(items).subspan(begin[key], begin[key + 1] - begin[key]);
  }
};
using Grouping = GroupingOf<std::uint32_t>;

/// Groups 0 .. n-1 by key_of(i) with a counting sort. Keys are below `key_count`. Calls `key_of` twice for each i.
/// Cost:   O(n + keys). Runs on the caller's TBB arena, and in parallel if there are many more items than keys.
template <class Item = std::uint32_t, class KeyOf>
GroupingOf<Item> group_by(std::size_t n, std::size_t key_count, const KeyOf& key_of, RunControl& control) {
  // Each block has counts of its own. Blocks are so large that all counts together are fewer than the items.
  constexpr std::size_t kLeast = 1 << 14;
  const std::size_t size = std::max(kLeast, 8 * key_count);
  const std::size_t blocks = (n + size - 1) / size;
  control.memory().ask_for<std::uint32_t>(blocks * key_count + key_count);
  control.memory().ask_for<Item>(n);
  std::vector<std::uint32_t> at(blocks * key_count, 0);
  const auto for_each_item = [&](const auto& visit) {
    for_blocks(n, size, control, [&](std::size_t begin, std::size_t end) {
      std::uint32_t* const of_block = at.data() + begin / size * key_count;
      for (std::size_t i = begin; i < end; ++i) visit(of_block[key_of(static_cast<std::uint32_t>(i))], i);
    });
  };
  for_each_item([](std::uint32_t& count, std::size_t) { ++count; });
  GroupingOf<Item> groups;
  groups.begin.reserve(key_count + 1);
  std::uint32_t total = 0;
  StopCheck check(control);
  for (std::size_t key = 0; key < key_count; ++key) {
    check();
    groups.begin.push_back(total);
    for (std::size_t block = 0; block < blocks; ++block) {
      const std::uint32_t count = at[block * key_count + key];
      at[block * key_count + key] = total;
      total += count;
    }
  }
  groups.begin.push_back(total);
  groups.items.resize(n);
  for_each_item(
      [&](std::uint32_t& place, std::size_t i) { groups.items[place++] = Item(static_cast<std::uint32_t>(i)); });
  return groups;
}

/// Sorts items into ascending order. That order must agree with key_of(item), a number below `key_count`.
/// Cost:   O(n + keys + n log m), where m is the largest number of items with one key. Few items with many keys cost
///         O(n log n), and items that are in order already cost O(n).
template <class Items, class KeyOf>
Items sorted_by_key(Items items, std::size_t key_count, const KeyOf& key_of, RunControl& control) {
  if (std::is_sorted(items.begin(), items.end())) return items;
  if (items.size() < key_count / 8) {
    sort_stoppable(items.begin(), items.end(), control);
    return items;
  }
  Items sorted(items.size());
  const Grouping groups = group_by(
      items.size(), key_count, [&](std::uint32_t i) { return key_of(items[i]); }, control);
  for_blocks(key_count, kItemsPerBlock, control, [&](std::size_t key, std::size_t end) {
    for (; key < end; ++key) {
      const auto first = sorted.begin() + groups.begin[key], last = sorted.begin() + groups.begin[key + 1];
      std::transform(groups[key].begin(), groups[key].end(), first, [&](std::uint32_t i) { return items[i]; });
      sort_stoppable(first, last, control);
    }
  });
  return sorted;
}

}  // namespace remesh
