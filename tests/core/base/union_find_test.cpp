#include "core/base/union_find.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

TEST(union_find, without_joins_everyone_stands_alone) {
  UnionFind sets(5);
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(sets.find(i), i);
}

TEST(union_find, the_smallest_member_represents_a_set_whatever_the_order_of_the_joins) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> joins = {{7, 3}, {3, 9}, {2, 8}, {8, 5}, {9, 9}};
  std::sort(joins.begin(), joins.end());
  do {
    UnionFind sets(10);
    for (const auto& [a, b] : joins) sets.join(a, b);
    const std::vector<std::uint32_t> expected = {0, 1, 2, 3, 4, 2, 6, 3, 2, 3};
    for (std::uint32_t i = 0; i < 10; ++i) ASSERT_EQ(sets.find(i), expected[i]);
  } while (std::next_permutation(joins.begin(), joins.end()));
}

TEST(union_find, random_joins_agree_with_relabelling) {
  constexpr std::uint32_t kMembers = 200;
  Random random(1);
  UnionFind sets(kMembers);
  std::vector<std::uint32_t> label(kMembers);
  for (std::uint32_t i = 0; i < kMembers; ++i) label[i] = i;
  for (int join = 0; join < 150; ++join) {
    const auto a = static_cast<std::uint32_t>(random.below(kMembers));
    const auto b = static_cast<std::uint32_t>(random.below(kMembers));
    sets.join(a, b);
    const auto [low, high] = std::minmax(label[a], label[b]);
    std::replace(label.begin(), label.end(), std::uint32_t{high}, std::uint32_t{low});
    for (std::uint32_t i = 0; i < kMembers; ++i) ASSERT_EQ(sets.find(i), label[i]);
  }
}

TEST(union_find, joins_by_several_threads_make_the_same_sets_as_joins_by_one) {
  constexpr int kMembers = 20'000;
  for (const std::size_t joins : {100, 5'000, 15'000, 40'000}) {
    Random random(joins);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs(joins);
    for (auto& [a, b] : pairs) {
      a = static_cast<std::uint32_t>(random.below(kMembers));
      b = static_cast<std::uint32_t>(random.below(kMembers));
    }
    UnionFind expected(kMembers), sets(kMembers);
    for (const auto& [a, b] : pairs) expected.join(a, b);
    tbb::parallel_for(std::size_t{0}, joins, [&](std::size_t i) { sets.join(pairs[i].first, pairs[i].second); });
    // Flattened by several threads, too: none may turn back what another one has done.
    UnionFind flat = sets;
    tbb::parallel_for(0u, std::uint32_t{kMembers}, [&](std::uint32_t i) { flat.flatten(i); });
    for (std::uint32_t i = 0; i < kMembers; ++i) {
      ASSERT_EQ(sets.find(i), expected.find(i)) << i;
      ASSERT_EQ(flat.root_of(i), expected.find(i)) << i;
    }
  }
}

TEST(union_find, a_long_chain_takes_near_linear_time) {
  constexpr std::uint32_t kMembers = 1'000'000;
  UnionFind sets(kMembers);
  for (std::uint32_t i = kMembers - 1; i > 0; --i) sets.join(i - 1, i);
  EXPECT_EQ(sets.find(kMembers - 1), 0u);
}

}  // namespace
}  // namespace remesh
