#include "core/base/sort_few.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

TEST(sort_few, it_sorts_few_and_many) {
  const RunControl control;
  Random random(3);
  for (const std::size_t n : {0u, 1u, 2u, 3u, 7u, 15u, 16u, 17u, 100u, 10000u})
    for (int i = 0; i < (n > 1000 ? 1 : 50); ++i) {
      std::vector<std::uint64_t> keys;
      for (std::size_t k = 0; k < n; ++k)
        keys.push_back(static_cast<std::uint64_t>(1e15 * random.unit()) * 128 + k);  // all different
      std::vector<std::uint64_t> sorted(n), expected = keys;
      sort_few(keys, sorted, control);
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(sorted, expected);
    }
}

}  // namespace
}  // namespace remesh
