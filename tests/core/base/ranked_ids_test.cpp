#include "core/base/ranked_ids.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

void expect_ranked(const RankedIds<VertexId>& ranked, const std::vector<VertexId>& given) {
  const std::set<VertexId> expected(given.begin(), given.end());
  ASSERT_EQ(std::vector(ranked.ids().begin(), ranked.ids().end()), std::vector(expected.begin(), expected.end()));
  ASSERT_EQ(ranked.size(), expected.size());
  for (std::uint32_t k = 0; k < ranked.size(); ++k) {
    EXPECT_EQ(ranked.rank(ranked[k]), k);
  }
}

TEST(ranked_ids, ids_are_in_order_and_know_their_rank_whether_few_or_many_of_a_range) {
  Random random(5);
  const RunControl control;
  RankedIds<VertexId> ranked;  // one after the other in the same memory
  for (const int n : {0, 1, 2, 40, 1000, 3})
    for (const int range : {1, 10, 1000, 2'000'000'000}) {
      std::vector<VertexId> ids;
      for (int i = 0; i < n; ++i) ids.push_back(VertexId(random.integer(0, range)));
      ranked.assign(ids, control);
      expect_ranked(ranked, ids);
    }
}

TEST(ranked_ids, the_largest_ids_have_ranks) {
  const RunControl control;
  RankedIds<VertexId> ranked;
  const std::vector<VertexId> ids{VertexId(0xfffffffeu), VertexId(0xfffffffdu), VertexId(0xfffffffeu)};
  ranked.assign(ids, control);
  expect_ranked(ranked, ids);
}

}  // namespace
}  // namespace remesh
