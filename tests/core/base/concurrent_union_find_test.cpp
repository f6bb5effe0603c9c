#include "core/base/concurrent_union_find.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <vector>

#include "core/base/union_find.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

TEST(ConcurrentUnionFind, without_joins_everyone_is_a_root) {
  const ConcurrentUnionFind sets(5);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_TRUE(sets.is_root(i));
}

TEST(ConcurrentUnionFind, joins_by_several_threads_make_the_same_sets_as_joins_by_one) {
  constexpr std::uint32_t kMembers = 20'000;
  for (const std::size_t joins : {100, 5'000, 15'000, 40'000}) {
    Random random(joins);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs(joins);
    for (auto& [a, b] : pairs) {
      a = static_cast<std::uint32_t>(random.below(kMembers));
      b = static_cast<std::uint32_t>(random.below(kMembers));
    }
    UnionFind expected(kMembers);
    for (const auto& [a, b] : pairs) expected.join(a, b);
    ConcurrentUnionFind sets(kMembers);
    tbb::parallel_for(std::size_t{0}, joins, [&](std::size_t i) { sets.join(pairs[i].first, pairs[i].second); });
    for (std::uint32_t i = 0; i < kMembers; ++i) ASSERT_EQ(sets.is_root(i), expected.find(i) == i) << i;
  }
}

TEST(ConcurrentUnionFind, a_long_chain_takes_near_linear_time) {
  constexpr std::uint32_t kMembers = 1'000'000;
  ConcurrentUnionFind sets(kMembers);
  for (std::uint32_t i = kMembers - 1; i > 0; --i) sets.join(i - 1, i);
  EXPECT_TRUE(sets.is_root(0));
  for (std::uint32_t i = 1; i < kMembers; ++i) ASSERT_FALSE(sets.is_root(i));
}

}  // namespace
}  // namespace remesh
