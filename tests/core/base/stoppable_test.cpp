#include "core/base/stoppable.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <numeric>
#include <vector>

#include "tests/support/errors.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

TEST(sort_stoppable, it_sorts_as_std_sort_does_whatever_the_number_of_items) {
  const RunControl control;
  Random random(1);
  for (const std::size_t n : {0u, 1u, 2u, 1000u, 8192u, 8193u, 100'000u}) {
    std::vector<std::uint64_t> items(n);
    for (std::uint64_t& item : items) item = random.bits() % (n + 1);
    std::vector<std::uint64_t> expected = items;
    std::sort(expected.begin(), expected.end());
    std::vector<std::uint64_t> sorted = items;
    sort_stoppable(sorted.begin(), sorted.end(), control);
    EXPECT_EQ(sorted, expected);
    std::sort(expected.begin(), expected.end(), std::greater<>());
    sort_stoppable(sorted.begin(), sorted.end(), control, std::greater<>());
    EXPECT_EQ(sorted, expected);
  }
}

TEST(sort_stoppable, it_ends_in_the_middle_when_it_is_stopped) {
  RunControl control;
  std::vector<std::uint32_t> items(1'000'000);
  std::iota(items.begin(), items.end(), 0u);
  std::reverse(items.begin(), items.end());
  std::atomic<std::size_t> comparisons = 0;
  const Error error = test::error_of([&] {
    sort_stoppable(items.begin(), items.end(), control, [&](std::uint32_t a, std::uint32_t b) {
      if (++comparisons == 1000) control.cancel();
      return a < b;
    });
  });
  EXPECT_EQ(error.code, Code::kCancelled);
  // Every thread makes no more than the comparison that it is at.
  EXPECT_LT(comparisons, 2000u);
}

TEST(stop_check, it_sees_a_stop_within_some_thousand_calls) {
  RunControl control;
  StopCheck check(control);
  for (int i = 0; i < 100'000; ++i) check();
  control.cancel();
  int calls = 0;
  EXPECT_EQ(test::error_of([&] {
              for (;; ++calls) check();
            }).code,
            Code::kCancelled);
  EXPECT_LT(calls, 10'000);
}

}  // namespace
}  // namespace remesh
