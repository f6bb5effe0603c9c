#include "core/base/large_first.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/invariance.h"

namespace remesh {
namespace {

TEST(large_first, only_what_is_above_the_limit_goes_before_the_rest) {
  const std::vector<std::size_t> work{3, 10, 0, 11, 12, 10, 12, 9};
  const LargeFirst result = large_first(work.size(), 10, [&](std::uint32_t i) { return work[i]; });
  EXPECT_EQ(result.order, (std::vector<std::uint32_t>{4, 6, 3, 0, 1, 2, 5, 7}));
  EXPECT_EQ(result.large, 3u);
}

TEST(large_first, nothing_has_an_order_too) {
  const LargeFirst result = large_first(0, 1, [](std::uint32_t) { return std::size_t{2}; });
  EXPECT_TRUE(result.order.empty());
  EXPECT_EQ(result.large, 0u);
}

TEST(for_large_first, each_item_has_its_turn_once) {
  RunControl control;
  for (const std::size_t n : {0u, 1u, 64u, 1000u}) {
    std::vector<int> turns(n, 0);
    for_large_first(
        n, 500, [](std::size_t i) { return i; }, control, [&](std::size_t i) { ++turns[i]; });
    EXPECT_EQ(turns, std::vector<int>(n, 1));
  }
}

STAGE(for_large_first, test::kStop) {
  for_large_first(
      5, std::size_t{10}, [](std::size_t) { return 5; }, trial.control, [](std::size_t) { FAIL(); });
}

}  // namespace
}  // namespace remesh
