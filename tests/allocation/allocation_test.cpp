/// The n-th allocation fails, for every n on a small mesh: there is an answer, or a clean 503, and nothing leaks.
#include <gtest/gtest.h>

#include <new>
#include <string>

#include "api/operations.h"
#include "server/daemon.h"
#include "tests/allocation/failing_new.h"
#include "tests/server/raw_client.h"
#include "tests/server/small_meshes.h"

namespace remesh::server {
namespace {

/// More than any of these requests allocates.
constexpr std::uint64_t kEnd = 200'000;

/// Calls `run` with the first, second, ... allocation failing, until none does. Output: how many there were.
template <typename Run>
std::uint64_t for_all_failures(const Run& run) {
  for (std::uint64_t n = 1; n < kEnd; ++n) {
    allocation::fail_at(n);
    run(n);
    const bool has_failed = allocation::has_failed();
    allocation::fail_at(0);
    if (!has_failed) return n - 1;
    if (::testing::Test::HasFailure()) break;
  }
  return kEnd;
}

void expect_no_leak(const std::string& target, const std::string& content_type) {
  api::Limits limits;
  limits.workers = 2;
  const auto run = [&] {
    RunControl control;
    api::Request request;
    request.body = kFrame;
    request.content_type = content_type;
    if (!target.empty()) request.query = {{"format", target}};
    return api::run_remesh(request, limits, control).status;
  };
  run();  // what is made once, at the first use
  run();
  const std::uint64_t failures = for_all_failures([&](std::uint64_t n) {
    const std::int64_t before = allocation::live();
    try {
      EXPECT_EQ(run(), 200);
    } catch (const std::bad_alloc&) {
      // a 503 with `out_of_memory`
    } catch (const std::exception& error) {
      ADD_FAILURE() << "allocation " << n << ": " << error.what();
    }
    // Scheduler threads may hold a few for a moment.
    EXPECT_TRUE(eventually([&] { return allocation::live() <= before; }))
        << "allocation " << n << " leaks " << allocation::live() - before;
  });
  EXPECT_GT(failures, 500u);
  EXPECT_LT(failures, kEnd);
  std::cout << failures << " allocations\n";
}

TEST(allocation_failure, a_remeshing_ends_cleanly_wherever_memory_runs_out) { expect_no_leak("", "model/obj"); }
TEST(allocation_failure, so_does_one_with_its_report) { expect_no_leak("json", "model/obj"); }

TEST(allocation_failure, the_daemon_answers_wherever_memory_runs_out) {
  log::set_up(log::Format::kText, log::Level::kOff);
  allocation::spare_this_thread();
  Config config;
  config.bind.port = 0;
  config.limits.workers = 2;
  config.max_running = 2;
  config.limits.queue.max_large = 16;
  Daemon daemon(config, Operations{});
  daemon.start();
  const std::string request =
      post_text("/v1/remesh?refine=false", kFrame, "Accept-Encoding: gzip\r\nTraceparent: 00-\r\n");
  for (int i = 0; i < 10; ++i) ASSERT_EQ(ask(daemon.port(), request).status, 200);
  const std::int64_t before = allocation::live();
  int answers = 0;
  int refusals = 0;
  const std::uint64_t failures = for_all_failures([&](std::uint64_t n) {
    const int status = ask(daemon.port(), request).status;
    ++(status == 200 ? answers : refusals);
    EXPECT_TRUE(status == 200 || status == 503) << "allocation " << n << ": " << status;
  });
  std::cout << failures << " allocations, " << answers << " answers, " << refusals << " refusals\n";
  EXPECT_LT(failures, kEnd);
  EXPECT_EQ(ask(daemon.port(), request).status, 200);
  EXPECT_TRUE(eventually([&] { return allocation::live() <= before + 50; })) << "leaks " << allocation::live() - before;
}

}  // namespace
}  // namespace remesh::server
