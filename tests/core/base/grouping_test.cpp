#include "core/base/grouping.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <numeric>
#include <vector>

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

TEST(grouping, stops_when_asked) {
  RunControl control;
  control.cancel();
  EXPECT_THROW(group_by(
                   10, 2, [](std::uint32_t i) { return i % 2; }, control),
               Error);
}

}  // namespace
}  // namespace remesh
