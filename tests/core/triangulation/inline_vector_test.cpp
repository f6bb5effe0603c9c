#include "core/triangulation/inline_vector.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

using Inline = InlineVector<std::uint32_t, 3>;

std::vector<std::uint32_t> items_of(const Inline& v) { return {v.begin(), v.end()}; }

TEST(inline_vector, it_does_what_a_vector_does) {
  Random random(5);
  for (int run = 0; run < 200; ++run) {
    Inline mine, other{};
    std::vector<std::uint32_t> expected, expected_of_other;
    for (std::uint32_t step = 0; step < 40; ++step) {
      switch (static_cast<int>(8 * random.unit())) {
        case 0: {
          const auto n = static_cast<std::size_t>(7 * random.unit());
          mine.resize(n, step);
          expected.resize(n, step);
          break;
        }
        case 1:
          mine.assign(2, step);
          expected.assign(2, step);
          break;
        case 2:
          std::swap(mine, other);
          std::swap(expected, expected_of_other);
          break;
        case 3:
          other = mine;
          expected_of_other = expected;
          break;
        case 4:
          mine = std::move(other);
          expected = std::exchange(expected_of_other, {});
          other.clear();
          break;
        case 5:
          mine.append({step, step + 1});
          expected.insert(expected.end(), {step, step + 1});
          break;
        default:
          mine.push_back(mine.empty() ? step : mine.front());
          expected.push_back(expected.empty() ? step : expected.front());
      }
      ASSERT_EQ(items_of(mine), expected);
      ASSERT_EQ(items_of(other), expected_of_other);
      const Inline copy(mine);
      ASSERT_TRUE(copy == mine);
    }
  }
}

TEST(inline_vector, few_items_stay_within_it) {
  Inline v;
  v.append({1, 2, 3});
  const auto* const begin = reinterpret_cast<const std::byte*>(&v);
  const auto* const data = reinterpret_cast<const std::byte*>(v.data());
  EXPECT_TRUE(data > begin && data < begin + sizeof v);
  Inline moved(std::move(v));
  EXPECT_EQ(items_of(moved), (std::vector<std::uint32_t>{1, 2, 3}));
  moved.push_back(4);
  const std::uint32_t* const far = moved.data();
  const Inline taken(std::move(moved));
  EXPECT_EQ(taken.data(), far);
}

}  // namespace
}  // namespace remesh
