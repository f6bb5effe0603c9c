#include "core/base/parallel.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

/// Waits for a condition, for minutes, so that a busy machine is not mistaken for a fault. Returns whether it has come
/// true.
template <class Condition>
bool comes_true(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(parallel, parts_that_work_on_few_items_run_one_after_the_other_on_the_thread_that_calls) {
  std::vector<std::pair<int, std::thread::id>> ran;  // without a lock
  do_all(
      kItemsWorthThreads - 1, [&] { ran.emplace_back(1, std::this_thread::get_id()); },
      [&] { ran.emplace_back(2, std::this_thread::get_id()); });
  const std::thread::id own = std::this_thread::get_id();
  EXPECT_EQ(ran, (std::vector<std::pair<int, std::thread::id>>{{1, own}, {2, own}}));
}

TEST(parallel, rows_of_any_kind_are_sorted) {
  constexpr int kItems = 20'000;
  Random random(6);
  const std::vector<std::function<int(int)>> kinds{[&](int) { return random.below(1'000'000); },
                                                   [&](int) { return random.below(3); },
                                                   [](int) { return 7; },
                                                   [](int i) { return i; },
                                                   [](int i) { return -i; },
                                                   [](int i) { return std::min(i, kItems - i); },
                                                   [](int i) { return i % 2; },
                                                   [](int i) { return i + 1 == kItems ? -1 : i; }};
  for (std::size_t kind = 0; kind < kinds.size(); ++kind)
    for (const int items : {kItemsWorthThreads, 1025, kItems}) {
      std::vector<int> row;
      for (int i = 0; i < items; ++i) row.push_back(kinds[kind](i));
      std::vector<int> sorted = row;
      std::sort(sorted.begin(), sorted.end(), std::greater<>());
      sort_all(row.begin(), row.end(), std::greater<>());
      EXPECT_EQ(row, sorted) << kind << ", " << items;
    }
}

TEST(parallel, a_row_that_divides_badly_is_sorted_by_one_thread) {
  static int divided = 0;
  std::vector<int> row;
  for (int i = 0; i < 20'000; ++i) row.push_back((7919 * i) % 20'011);
  const parallel::SortSteps steps{row.data(),
                                  [](const void* of_row, std::size_t begin, std::size_t end) {
                                    int* const first = const_cast<int*>(static_cast<const int*>(of_row));
                                    std::sort(first + begin, first + end);
                                  },
                                  [](const void* of_row, std::size_t begin, std::size_t end) {
                                    int* const first = const_cast<int*>(static_cast<const int*>(of_row));
                                    std::iter_swap(first + begin, std::min_element(first + begin, first + end));
                                    ++divided;
                                    return std::pair(begin, begin + 1);
                                  }};
  parallel::run_sort(steps, row.size());
  EXPECT_TRUE(std::is_sorted(row.begin(), row.end()));
  EXPECT_LT(divided, 100);
}

TEST(parallel, a_comparison_may_throw) {
  Random random(6);
  std::vector<int> row;
  for (int i = 0; i < 20'000; ++i) row.push_back(random.below(1'000'000));
  std::atomic<int> left = 100'000;
  EXPECT_THROW(sort_all(row.begin(), row.end(),
                        [&](int a, int b) {
                          if (--left == 0) throw std::runtime_error("too many comparisons");
                          return a < b;
                        }),
               std::runtime_error);
}

TEST(parallel, a_task_goes_no_further_than_its_loop_once_another_task_has_thrown) {
  // On a machine of one processor there would be one thread.
  const tbb::global_control two_threads(tbb::global_control::max_allowed_parallelism, 2);
  tbb::task_arena arena(2);
  for (int kind = 0; kind < 3; ++kind) {
    std::atomic<bool> is_inside = false, are_both_there = false, has_gone_on = false;
    const auto fail = [&] {
      are_both_there = comes_true([&] { return is_inside.load(); });
      throw std::runtime_error("the first");
    };
    const auto wait = [&] {
      is_inside = true;
      comes_true([] { return tbb::is_current_task_group_canceling(); });
    };
    const auto loop = [&] {
      if (kind == 0) for_all(0, 2, [&](std::size_t) { wait(); });
      if (kind == 1) do_all(kItemsWorthThreads, wait, wait);
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
      arena.execute([&] { do_all(kItemsWorthThreads, fail, loop); });
      ADD_FAILURE() << kind;
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "the first");
    }
    ASSERT_TRUE(are_both_there) << "no second thread came";
    EXPECT_FALSE(has_gone_on) << kind;
  }
}

}  // namespace
}  // namespace remesh
