#include "core/base/large_first.h"

#include <gtest/gtest.h>

#include <vector>

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

}  // namespace
}  // namespace remesh
