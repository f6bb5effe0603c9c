#include "core/base/small_blocks.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "tests/allocation/failing_new.h"

namespace remesh {
namespace {

TEST(small_blocks, what_a_vector_has_outgrown_goes_back_at_once) {
  SmallBlocks memory(64);
  std::pmr::vector<int> grown(&memory);
  grown.resize(10'000);
  const std::int64_t before = allocation::live();
  for (int n = 0; n < 100; ++n) {
    grown.push_back(n);
    grown.reserve(grown.capacity() + 1);
  }
  EXPECT_EQ(allocation::live(), before);
}

TEST(small_blocks, all_blocks_go_back_with_it) {
  const std::int64_t before = allocation::live();
  {
    SmallBlocks memory(64);
    std::vector<std::pmr::vector<int>> grown(100, std::pmr::vector<int>(&memory));
    for (int n = 0; n < 1000; ++n)
      for (auto& v : grown) v.push_back(n);
    EXPECT_GT(allocation::live(), before);
  }
  EXPECT_EQ(allocation::live(), before);
}

}  // namespace
}  // namespace remesh
