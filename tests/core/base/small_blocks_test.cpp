#include "core/base/small_blocks.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <numeric>
#include <utility>
#include <vector>

namespace remesh {
namespace {

TEST(small_blocks, vectors_that_grow_in_turns_keep_what_they_have) {
  SmallBlocks memory(64);
  std::vector<std::pmr::vector<int>> grown;
  for (int i = 0; i < 20; ++i) grown.emplace_back(&memory);
  for (int n = 0; n < 1000; ++n)
    for (auto& v : grown) v.push_back(n);
  std::vector<int> expected(1000);
  std::iota(expected.begin(), expected.end(), 0);
  for (const auto& v : grown) EXPECT_EQ(std::vector<int>(v.begin(), v.end()), expected);
}

TEST(small_blocks, every_block_is_aligned_as_asked) {
  SmallBlocks memory(100);
  for (const std::size_t alignment : {1, 2, 8, 16})
    for (const std::size_t bytes : {1, 3, 24, 500, 5000}) {
      void* const at = memory.allocate(bytes, alignment);
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(at) % alignment, 0u);
      memory.deallocate(at, bytes, alignment);
    }
}

TEST(small_blocks, vectors_of_one_memory_hand_over_without_a_copy) {
  SmallBlocks memory(256);
  std::pmr::vector<int> from({1, 2, 3}, &memory);
  const int* const at = from.data();
  std::pmr::vector<int> to(&memory);
  to = std::move(from);
  EXPECT_EQ(to.data(), at);
}

TEST(stack_memory, short_vectors_are_on_the_stack_and_long_ones_elsewhere) {
  StackMemory memory;
  const auto is_inside = [&](const void* at) {
    const auto begin = reinterpret_cast<std::uintptr_t>(&memory), place = reinterpret_cast<std::uintptr_t>(at);
    return place >= begin && place < begin + sizeof memory;
  };
  const std::pmr::vector<int> few(10, 1, &memory), many(10'000, 2, &memory);
  EXPECT_TRUE(is_inside(few.data()));
  EXPECT_FALSE(is_inside(many.data()));
  EXPECT_EQ(std::accumulate(many.begin(), many.end(), 0), 20'000);
}

}  // namespace
}  // namespace remesh
