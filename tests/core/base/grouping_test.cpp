#include "core/base/grouping.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

TEST(grouping, items_stand_with_their_keys_in_the_order_of_a_stable_sort) {
  // Few keys: several blocks; as many keys as items: one block.
  for (const auto& [n, keys] : std::vector<std::pair<int, int>>{{0, 0}, {0, 5}, {3, 1}, {100'000, 7}, {50'000, 60'000}})
    for (const std::size_t threads : {1, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      Random random(1);
      std::vector<std::uint32_t> key(n);
      for (std::uint32_t& k : key) k = static_cast<std::uint32_t>(random.below(keys) / 2);
      RunControl control;
      const Grouping groups = group_by(
          key.size(), static_cast<std::size_t>(keys), [&](std::uint32_t i) { return key[i]; }, control);
      decltype(Grouping::items) expected(key.size());
      std::iota(expected.begin(), expected.end(), 0u);
      std::stable_sort(expected.begin(), expected.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return key[a] < key[b]; });
      EXPECT_EQ(groups.items, expected);
      ASSERT_EQ(groups.begin.size(), static_cast<std::size_t>(keys) + 1);
      EXPECT_EQ(groups.begin.back(), key.size());
      for (std::uint32_t k = 0; k < static_cast<std::uint32_t>(keys); ++k)
        for (const std::uint32_t i : groups[k]) ASSERT_EQ(key[i], k);
    }
}

using Item = std::array<std::uint32_t, 2>;

/// Returns random items with keys below `keys`. Some items may be equal.
std::vector<Item> items(std::size_t n, int keys, std::uint64_t seed) {
  Random random(seed);
  std::vector<Item> items(n);
  for (Item& item : items)
    item = {static_cast<std::uint32_t>(random.below(keys)), static_cast<std::uint32_t>(random.below(50))};
  return items;
}

TEST(grouping, items_sorted_by_key_are_in_order) {
  // Few items with many keys; most of them with one; as many as there are keys.
  for (const auto& [n, keys] : std::vector<std::pair<std::size_t, int>>{
           {0, 1}, {1, 9}, {100, 1000}, {80'000, 1}, {80'000, 2}, {50'000, 40'000}})
    for (const std::size_t threads : {1, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      RunControl control;
      const std::vector<Item> given = items(n, keys, 1);
      const auto sorted = [&control, key_count = static_cast<std::size_t>(keys)](const std::vector<Item>& of) {
        return sorted_by_key(
            of, key_count, [](const Item& item) { return item[0]; }, control);
      };
      std::vector<Item> expected = given;
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(sorted(given), expected);
      EXPECT_EQ(sorted(expected), expected);
    }
}

STAGE(grouping, test::kStop) {
  group_by(
      10, 2, [](std::uint32_t i) { return i % 2; }, trial.control);
}

STAGE(sorted_by_key, test::kStop) {
  sorted_by_key(
      items(100, 100, 2), 100, [](const Item& item) { return item[0]; }, trial.control);
}

}  // namespace
}  // namespace remesh
