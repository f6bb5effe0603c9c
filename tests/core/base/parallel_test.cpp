#include "core/base/parallel.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <vector>

namespace remesh {
namespace {

/// Waits for a condition, for so long at most. Returns whether it has come true.
template <class Condition>
bool comes_true(std::chrono::seconds at_most, const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + at_most;
  while (!condition())
    if (std::chrono::steady_clock::now() > end) return false;
  return true;
}

TEST(parallel, a_task_goes_no_further_than_its_loop_once_another_task_has_thrown) {
  tbb::task_arena arena(2);
  for (int kind = 0; kind < 3; ++kind) {
    std::atomic<bool> is_inside = false, are_both_there = false, has_gone_on = false;
    const auto fail = [&] {
      are_both_there = comes_true(std::chrono::seconds(5), [&] { return is_inside.load(); });
      throw std::runtime_error("the first");
    };
    const auto wait = [&] {
      is_inside = true;
      comes_true(std::chrono::minutes(2), [] { return tbb::is_current_task_group_canceling(); });
    };
    const auto loop = [&] {
      if (kind == 0) for_all(0, 2, [&](int) { wait(); });
      if (kind == 1) do_all(wait, wait);
      if (kind == 2) {
        std::vector<int> numbers(10'000);
        for (int i = 0; i < 10'000; ++i) numbers[static_cast<std::size_t>(i)] = 7919 * i % 10'007;
        sort_all(numbers.begin(), numbers.end(), [&](int a, int b) {
          if (!is_inside) wait();
          return a < b;
        });
      }
      has_gone_on = true;
    };
    try {
      arena.execute([&] { do_all(fail, loop); });
      ADD_FAILURE() << kind;
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "the first");
    }
    if (!are_both_there) GTEST_SKIP() << "no second thread came within five seconds";
    EXPECT_FALSE(has_gone_on) << kind;
  }
}

}  // namespace
}  // namespace remesh
