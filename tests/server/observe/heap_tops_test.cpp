#include "server/observe/heap_tops.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <latch>
#include <memory>
#include <thread>
#include <vector>

#include "api/machine_limits.h"
#include "server/work/worker_pool.h"
#include "tests/server/stub_daemon.h"
#include "tests/support/sanitizer.h"

namespace remesh::server {
namespace {

constexpr std::size_t kBlock = 256 << 10;
constexpr std::size_t kBlocks = 160;        // 40 MiB, less than the usual threshold
constexpr std::uint64_t kMuch = 16 << 20;   // what the end of one heap retains at least
constexpr std::uint64_t kLittle = 4 << 20;  // what may remain of all

/// Fills memory of the calling thread's heap and frees it.
void use_and_free() {
  std::vector<std::unique_ptr<char[]>> blocks;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    blocks.push_back(std::make_unique<char[]>(kBlock));
    std::fill_n(blocks.back().get(), kBlock, 'x');
  }
}

TEST(heap_tops, malloc_trim_leaves_what_a_thread_returns) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  HeapTops::set_thresholds();
  ::malloc_trim(0);
  const std::uint64_t before = api::resident_memory();
  std::latch is_freed{1};
  std::latch may_return{1};
  std::latch has_returned{1};
  std::latch may_end{1};
  std::thread thread([&] {
    use_and_free();
    is_freed.count_down();
    may_return.wait();
    HeapTops::return_if_asked();
    has_returned.count_down();
    may_end.wait();
  });
  is_freed.wait();
  ::malloc_trim(0);
  EXPECT_GT(api::resident_memory(), before + kMuch) << "malloc_trim is enough";
  HeapTops::ask();
  may_return.count_down();
  has_returned.wait();
  EXPECT_LT(api::resident_memory(), before + kLittle);
  may_end.count_down();
  thread.join();
}

TEST(heap_tops, a_pool_without_work_returns_them_once_it_is_asked) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  HeapTops::set_thresholds();
  constexpr int kThreads = 2;
  WorkerPool pool(kThreads, api::QueueLimits{}, kThreads);
  ::malloc_trim(0);
  const std::uint64_t before = api::resident_memory();
  std::latch are_freed{kThreads};
  for (int i = 0; i < kThreads; ++i) {
    const bool is_queued = pool.try_submit([&] {
                                 HeapTops::return_if_asked();  // by other tests
                                 use_and_free();
                                 are_freed.arrive_and_wait();
                               })
                               .has_value();
    if (!is_queued) are_freed.count_down();
    EXPECT_TRUE(is_queued);
  }
  are_freed.wait();
  ::malloc_trim(0);
  ASSERT_GT(api::resident_memory(), before + kMuch) << "malloc_trim is enough";
  HeapTops::ask();
  EXPECT_TRUE(eventually([&] { return api::resident_memory() < before + kLittle; }));
}

}  // namespace
}  // namespace remesh::server
