#include "core/base/blocks.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace remesh {
namespace {

TEST(concatenate, keeps_the_order_of_blocks_and_of_their_items) {
  RunControl control;
  // There are more blocks than are put together in one task, and some of them are empty.
  std::vector<std::vector<int>> blocks(1000);
  std::vector<std::int64_t> expected;
  for (int b = 0; b < 1000; ++b)
    for (int i = 0; i < b * 7 % 40; ++i) {
      blocks[static_cast<std::size_t>(b)].push_back(100 * b + i);
      expected.push_back(-(100 * b + i));
    }
  const auto all = concatenate<std::int64_t>(blocks, control, [](int item) { return -std::int64_t{item}; });
  EXPECT_EQ(std::vector<std::int64_t>(all.begin(), all.end()), expected);
}

TEST(concatenate, nothing_of_nothing) {
  RunControl control;
  EXPECT_TRUE(concatenate<int>(std::vector<std::vector<int>>(), control).empty());
  EXPECT_TRUE(concatenate<int>(std::vector<std::vector<int>>(100), control).empty());
}

}  // namespace
}  // namespace remesh
