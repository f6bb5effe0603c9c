/// Items grouped by small numbers, in parallel.
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

/// The numbers 0 .. n-1 by their keys.
template <class Item>
struct GroupingOf {
  std::vector<std::uint32_t> begin;          ///< of each key's items; one entry more than there are keys
  std::vector<Item, LeftUnset<Item>> items;  ///< ascending in each group

  std::span<const Item> operator[](std::size_t key) const {
    return std::span(items).subspan(begin[key], begin[key + 1] - begin[key]);
  }
};
using Grouping = GroupingOf<std::uint32_t>;

/// A counting sort of 0 .. n-1 by key_of(i), which is below `key_count` and asked for twice.
/// Cost:   O(n + keys); on the caller's TBB arena, as far as there are many more items than keys.
template <class Item = std::uint32_t, class KeyOf>
GroupingOf<Item> group_by(std::size_t n, std::size_t key_count, const KeyOf& key_of, RunControl& control) {
  // Each block counts for itself; so many items in each that all counts together are fewer than items.
  constexpr std::size_t kLeast = 1 << 14;
  const std::size_t size = std::max(kLeast, 8 * key_count);
  const std::size_t blocks = (n + size - 1) / size;
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

/// Items in ascending order, which begins with key_of(item), a number below `key_count`.
/// Cost:   O(n + keys + n log m), where m items have one key. Few items with many keys: O(n log n). In order already:
///         O(n).
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
