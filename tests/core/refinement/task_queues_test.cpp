#include "core/refinement/refiner/task_queues.h"

#include <gtest/gtest.h>

#include <deque>
#include <map>

#include "tests/support/random.h"

namespace remesh {
namespace {

using Queues = TaskQueues<int>;

/// A model of the queues that is a plain map. It tells which task must pop next.
class Expected {
 public:
  void push(std::size_t queue, int task) { queues_[queue].push_back(task); }
  int pop() {
    const auto highest = std::prev(queues_.end());
    const int task = highest->second.front();
    highest->second.pop_front();
    if (highest->second.empty()) queues_.erase(highest);
    return task;
  }
  bool empty() const { return queues_.empty(); }

 private:
  std::map<std::size_t, std::deque<int>> queues_;
};

constexpr auto kNothing = [](int) {};

TEST(task_queues, nothing_comes_out_of_empty_ones) {
  Queues queues;
  int task = 0;
  EXPECT_FALSE(queues.pop(task, kNothing));
  EXPECT_EQ(queues.size(), 0u);
}

TEST(task_queues, the_highest_comes_first_and_in_it_who_came_first) {
  for (const std::uint16_t block : std::initializer_list<std::uint16_t>{1, 2, 8}) {
    Queues queues;
    queues.clear(block);
    Expected expected;
    Random random(block);
    std::size_t waiting = 0;
    for (int step = 0; step < 20'000; ++step) {
      // More come than go, and then the other way round.
      const bool is_push = expected.empty() || random.unit() < (step / 5000 % 2 == 0 ? 0.6 : 0.4);
      if (is_push) {
        const auto queue = static_cast<std::size_t>(random.integer(0, 6));
        queues.push(queue, step);
        expected.push(queue, step);
        ++waiting;
      } else {
        int task = -1;
        ASSERT_TRUE(queues.pop(task, kNothing));
        ASSERT_EQ(task, expected.pop());
        --waiting;
      }
      ASSERT_EQ(queues.size(), waiting);
    }
  }
}

TEST(task_queues, cleared_they_begin_anew) {
  Queues queues;
  for (int i = 0; i < 20; ++i) queues.push(static_cast<std::size_t>(i % 3), i);
  int task = 0;
  for (int i = 0; i < 5; ++i) queues.pop(task, kNothing);
  queues.clear(4);
  EXPECT_EQ(queues.size(), 0u);
  EXPECT_FALSE(queues.pop(task, kNothing));
  for (int i = 1; i <= 9; ++i) queues.push(1, i);
  for (int i = 1; i <= 9; ++i) {
    ASSERT_TRUE(queues.pop(task, kNothing));
    EXPECT_EQ(task, i);
  }
}

TEST(task_queues, a_task_is_announced_a_block_before_it_comes) {
  Queues queues;
  queues.clear(4);
  for (int i = 1; i <= 12; ++i) queues.push(3, i);
  int task = 0, announced = 0;
  for (int i = 1; i <= 8; ++i) {
    ASSERT_TRUE(queues.pop(task, [&](int soon) { announced = soon; }));
    EXPECT_EQ(task, i);
    EXPECT_EQ(announced, i + 4);
  }
}

}  // namespace
}  // namespace remesh
