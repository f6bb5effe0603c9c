#include "server/work/worker_pool.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <thread>
#include <vector>

#include "tests/server/raw_client.h"
#include "tests/support/time_limit.h"

namespace remesh::server {
namespace {

constexpr std::uint64_t kLarge = WorkerPool::kSmallBytes + 1;

api::QueueLimits queue_of(std::size_t max_large) { return {.max_large = max_large}; }

TEST(worker_pool, jobs_run_within_an_arena_of_the_workers_asked_for) {
  WorkerPool pool(2, queue_of(4), 3);
  std::promise<int> concurrency;
  ASSERT_TRUE(pool.try_submit([&] { concurrency.set_value(tbb::this_task_arena::max_concurrency()); }));
  EXPECT_EQ(concurrency.get_future().get(), 3);
}

TEST(worker_pool, it_refuses_at_once_when_threads_and_queue_are_full) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  std::atomic<int> finished = 0;
  {
    WorkerPool pool(2, queue_of(3), 1);
    for (int i = 0; i < 5; ++i) {
      EXPECT_FALSE(pool.is_full(kLarge));
      const auto finish = [&] {
        open.wait();
        ++finished;
      };
      EXPECT_TRUE(pool.try_submit(finish, kLarge));
    }
    EXPECT_TRUE(pool.is_full(kLarge));
    EXPECT_FALSE(pool.try_submit([&] { ++finished; }, kLarge));
    ASSERT_TRUE(eventually([&] { return pool.running() == 2 && pool.queued() == 3; }));
    gate.set_value();
    ASSERT_TRUE(eventually([&] { return finished == 5; }));
    ASSERT_TRUE(eventually([&] { return !pool.is_full(kLarge); }));
  }
  EXPECT_EQ(finished, 5);
}

TEST(worker_pool, a_job_that_waits_can_be_withdrawn_and_gives_up_its_place) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  std::atomic<bool> ran = false;
  WorkerPool pool(1, queue_of(1), 1);
  const auto first = pool.try_submit([&] { open.wait(); }, kLarge);
  ASSERT_TRUE(eventually([&] { return pool.running() == 1; }));
  const auto second = pool.try_submit([&] { ran = true; }, kLarge);
  ASSERT_TRUE(first && second);
  EXPECT_FALSE(pool.withdraw(*first));
  EXPECT_TRUE(pool.is_full(kLarge));
  EXPECT_TRUE(pool.withdraw(*second));
  EXPECT_FALSE(pool.withdraw(*second));
  EXPECT_FALSE(pool.is_full(kLarge));
  gate.set_value();
  ASSERT_TRUE(eventually([&] { return pool.running() == 0; }));
  EXPECT_FALSE(ran);
}

TEST(worker_pool, jobs_start_in_the_order_in_which_they_came) {
  std::vector<int> order;
  std::promise<void> last;
  WorkerPool pool(1, queue_of(10), 1);
  for (int i = 0; i < 10; ++i) {
    pool.try_submit([&order, &last, i] {
      order.push_back(i);
      if (i == 9) last.set_value();
    });
  }
  last.get_future().wait();
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
}

TEST(worker_pool, a_long_job_does_not_hold_up_short_ones_while_a_thread_is_free) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  WorkerPool pool(2, queue_of(100), 1);
  pool.try_submit([&] { open.wait(); });
  std::atomic<int> finished = 0;
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(pool.try_submit([&] { ++finished; }));
  EXPECT_TRUE(eventually([&] { return finished == 50; }));
  EXPECT_TRUE(eventually([&] { return pool.running() == 1; }));
  gate.set_value();
}

TEST(worker_pool, small_jobs_pass_while_large_ones_hold_every_place) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  std::atomic<int> small = 0;
  WorkerPool pool(2, queue_of(8), 1);
  const auto wait = [&] { open.wait(); };
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(pool.try_submit(wait, kLarge));
  ASSERT_TRUE(eventually([&] { return pool.running() == 2; }));
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(pool.try_submit([&] { ++small; }));
  EXPECT_TRUE(eventually([&] { return small == 3; }));
  EXPECT_TRUE(eventually([&] { return pool.running() == 2; }));
  gate.set_value();
  EXPECT_TRUE(eventually([&] { return pool.running() == 0 && pool.queued() == 0; }));
}

TEST(worker_pool, small_jobs_pass_those_that_have_run_for_long) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  std::atomic<bool> ran = false;
  WorkerPool pool(1, queue_of(8), 1);
  const auto start = Clock::now();
  ASSERT_TRUE(pool.try_submit([&] { open.wait(); }));
  ASSERT_TRUE(pool.try_submit([&] { ran = true; }));
  EXPECT_TRUE(eventually([&] { return ran.load(); }));
  EXPECT_GE(Clock::now() - start, WorkerPool::kLong);
  gate.set_value();
}

TEST(worker_pool, each_one_that_runs_for_long_lets_another_pass) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  std::atomic<bool> ran = false;
  WorkerPool pool(2, queue_of(8), 1);
  // Two hold the places, the third passes and runs for long, too.
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(pool.try_submit([&] { open.wait(); }));
  ASSERT_TRUE(pool.try_submit([&] { ran = true; }));
  EXPECT_TRUE(eventually([&] { return ran.load(); }));
  gate.set_value();
}

TEST(worker_pool, a_place_that_opens_earlier_than_was_known_is_taken_then) {
  const auto time_until_it_is_taken = [] {
    std::promise<void> gate;
    const std::shared_future<void> open(gate.get_future());
    std::promise<Clock::time_point> ran;
    const auto wait = [&] { open.wait(); };
    WorkerPool pool(2, queue_of(8), 1);
    const auto start = Clock::now();
    EXPECT_TRUE(pool.try_submit(wait));
    std::this_thread::sleep_until(start + WorkerPool::kLong * 95 / 100);
    // A short one, during which a large one and a small one come: the large one takes its place, and so the small one
    // may pass when the first has run for long, not when the short one would have.
    EXPECT_TRUE(pool.try_submit([&] { std::this_thread::sleep_until(start + WorkerPool::kLong * 97 / 100); }));
    EXPECT_TRUE(pool.try_submit(wait, kLarge));
    EXPECT_TRUE(pool.try_submit([&] { ran.set_value(Clock::now()); }));
    const auto took = ran.get_future().get() - start;
    EXPECT_GE(took, WorkerPool::kLong);
    gate.set_value();
    return took;
  };
  // It takes little more than kLong. If the pool waited for the short one to have run for long, it would be 1.95 kLong
  // at least, however often it is tried. A busy machine may hold up one attempt, but not all of them.
  auto best = time_until_it_is_taken();
  for (int more = 9; more > 0 && best >= WorkerPool::kLong * 19 / 10; --more)
    best = std::min(best, time_until_it_is_taken());
  test::expect_sooner_than(WorkerPool::kLong * 19 / 10, best);
}

TEST(worker_pool, none_of_many_jobs_from_many_threads_is_forgotten) {
  constexpr int kClients = 8;
  constexpr int kJobs = 2000;
  WorkerPool pool(2, queue_of(kClients), 1);
  std::vector<std::thread> clients;
  std::atomic<int> done = 0;
  for (int c = 0; c < kClients; ++c) {
    clients.emplace_back([&, c] {
      for (int i = 0; i < kJobs; ++i) {
        std::promise<void> ran;
        const std::uint64_t bytes = (c + i) % 16 == 0 ? kLarge : 0;
        while (!pool.try_submit([&] { ran.set_value(); }, bytes)) std::this_thread::yield();
        if (ran.get_future().wait_for(kPatience) == std::future_status::ready) ++done;
      }
    });
  }
  for (std::thread& client : clients) client.join();
  EXPECT_EQ(done, kClients * kJobs);
}

TEST(worker_pool, large_jobs_leave_small_ones_their_part_of_the_queue) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  WorkerPool pool(1, queue_of(4), 1);
  const auto wait = [&] { open.wait(); };
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(pool.try_submit(wait, kLarge));
  EXPECT_TRUE(pool.is_full(kLarge));
  EXPECT_FALSE(pool.try_submit(wait, kLarge));
  EXPECT_TRUE(pool.try_submit([] {}));
  gate.set_value();
}

TEST(worker_pool, small_jobs_wait_by_the_hundred) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  std::atomic<int> finished = 0;
  WorkerPool pool(1, queue_of(1), 1);
  ASSERT_TRUE(pool.try_submit([&] { open.wait(); }));
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(pool.try_submit([&] { ++finished; }, 1000)) << i;
  gate.set_value();
  EXPECT_TRUE(eventually([&] { return finished == 500; }));
}

TEST(worker_pool, the_bodies_of_small_jobs_that_wait_are_limited_together) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  WorkerPool pool(1, {.max_large = 1, .max_small_bytes = 1000}, 1);
  const auto wait = [&] { open.wait(); };
  ASSERT_TRUE(pool.try_submit(wait));
  ASSERT_TRUE(eventually([&] { return pool.running() == 1; }));
  const auto first = pool.try_submit(wait, 5000);
  ASSERT_TRUE(first) << "one may always wait";
  EXPECT_TRUE(pool.is_full(1));
  EXPECT_FALSE(pool.try_submit(wait, 1));
  ASSERT_TRUE(pool.withdraw(*first));
  EXPECT_TRUE(pool.try_submit(wait, 600));
  EXPECT_TRUE(pool.try_submit(wait, 400));
  EXPECT_FALSE(pool.try_submit(wait, 1));
  EXPECT_TRUE(pool.try_submit(wait, kLarge));
  gate.set_value();
}

TEST(worker_pool, the_time_that_small_jobs_have_taken_limits_how_many_may_wait) {
  std::promise<void> gate;
  const std::shared_future<void> open(gate.get_future());
  WorkerPool pool(1, {.max_large = 1, .max_small_wait = std::chrono::milliseconds(1)}, 1);
  const auto wait = [&] { open.wait(); };
  EXPECT_EQ(pool.expected_wait().count(), 0);
  // One part in 32 of it, the first average, is ten times the limit.
  ASSERT_TRUE(pool.try_submit([] { std::this_thread::sleep_for(std::chrono::milliseconds(320)); }));
  ASSERT_TRUE(eventually([&] { return pool.running() == 0 && pool.queued() == 0; }));
  ASSERT_TRUE(pool.try_submit(wait));
  ASSERT_TRUE(eventually([&] { return pool.running() == 1; }));
  EXPECT_TRUE(pool.try_submit(wait));
  EXPECT_GE(pool.expected_wait(), std::chrono::milliseconds(10));
  EXPECT_FALSE(pool.try_submit(wait));
  gate.set_value();
}

}  // namespace
}  // namespace remesh::server
