#include <algorithm>
#include <atomic>
#include <cstdio>
#include <string>
#include <thread>

#include "tests/load/client.h"
#include "tests/load/scenarios.h"
#include "tests/server/daemon_process.h"
#include "tests/server/small_meshes.h"

namespace remesh::load {
namespace {

constexpr std::uint64_t kBudget = 512ull << 20;

/// Returns how many requests are served per second if clients ask again as soon as they have their answer. The clients
/// are few enough for each to find a place: one that is refused would ask again thousands of times a second, and would
/// take the processors from the workers.
double peak_throughput(int port, const std::string& request, double seconds) {
  std::atomic<int> served = 0;
  const Clock::time_point end = Clock::now() + std::chrono::milliseconds(static_cast<int>(seconds * 1000));
  in_parallel(2 * std::thread::hardware_concurrency(), [&](std::size_t) {
    while (Clock::now() < end) served += perform(port, request).status == 200 ? 1 : 0;
  });
  return served / seconds;
}

}  // namespace

int overload(double seconds, bool judges_times) {
  const server::DaemonProcess daemon({"--memory-budget", std::to_string(kBudget), "--max-connections-per-address",
                                      "512",
                                      // Small requests wait for a fifth of it, so that some of these are refused.
                                      "--request-timeout", "500ms", "--ops-bind", "127.0.0.1:0"});
  const int port = daemon.port();
  const std::string request = post_text("/v1/remesh?refine=false", server::bumpy_sheet(40));
  peak_throughput(port, request, 1);  // warm
  const double peak_seconds = std::clamp(seconds / 4, 2.0, 10.0);
  const double peak_before = peak_throughput(port, request, peak_seconds);
  const double rate = 3 * peak_before;

  // Requests are sent at fixed times, whatever became of those before. There are as many threads as requests can wait
  // at once.
  const auto total = static_cast<std::size_t>(rate * seconds);
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> served = 0;
  std::atomic<std::size_t> rejected = 0;
  std::atomic<std::size_t> expired = 0;
  std::atomic<std::size_t> lost = 0;
  std::atomic<std::size_t> other = 0;
  Times rejections;
  Times live;
  std::uint64_t memory = 0;
  std::atomic<bool> goes_on = true;
  std::thread watcher([&] {
    while (goes_on) {
      memory = std::max(memory, daemon.memory("VmRSS"));
      live.add(perform(daemon.ops_port(), get_text("/livez")).ms);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  const Neighbours neighbours(daemon.pid());
  const Clock::time_point start = Clock::now();
  in_parallel(64, [&](std::size_t) {
    for (std::size_t i = next++; i < total; i = next++) {
      const auto due = std::chrono::duration<double>(static_cast<double>(i) / rate);
      std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(due));
      const Outcome outcome = perform(port, request);
      if (outcome.status == 200) ++served;
      if (outcome.status == 503) ++rejected;
      if (outcome.status == 0) ++lost;
      if (outcome.status == 503) rejections.add(outcome.ms);
      if (outcome.status == 504) ++expired;
      if (outcome.status != 0 && outcome.status != 200 && outcome.status != 503 && outcome.status != 504) ++other;
    }
  });
  const double took = std::chrono::duration<double>(Clock::now() - start).count();
  goes_on = false;
  watcher.join();
  // The peak is measured before and after the load, because within a minute a shared machine becomes faster or slower
  // by more than is asked here.
  const double peak = (peak_before + peak_throughput(port, request, peak_seconds)) / 2;

  Verdict verdict(judges_times);
  const double throughput = static_cast<double>(served) / took;
  std::printf("peak %.1f a second; %.1f a second asked for %.0f s: %zu served, %zu rejected\n", peak,
              static_cast<double>(total) / took, took, served.load(), rejected.load());
  verdict.expect_in_time(static_cast<double>(total) / took > 2.5 * peak_before,
                         "the load was about three times the peak before it", neighbours);
  // A few seconds are not enough to know the peak to 5 %.
  const double share = seconds < 30 ? 0.8 : 0.95;
  verdict.expect_in_time(throughput >= share * peak, "served: " + with_unit(100 * throughput / peak, "% of the peak"),
                         neighbours);
  const double in_time = neighbours.without_stolen(0.99);
  verdict.expect_in_time(rejections.quantile(in_time) <= 10,
                         with_unit(100 * in_time, "% of the rejections within 10 ms: half within ") +
                             with_unit(rejections.quantile(0.5), "ms, so many within ") +
                             with_unit(rejections.quantile(in_time), "ms, 99 % within ") +
                             with_unit(rejections.quantile(0.99), "ms, at most ") +
                             with_unit(rejections.quantile(1), "ms"),
                         neighbours);
  verdict.expect(lost == 0 && other == 0, "no request without an answer, none with a wrong one");
  verdict.expect_in_time(expired == 0, "none was begun and not ended in its time", neighbours);
  verdict.expect(memory < kBudget, "memory at most " + with_unit(static_cast<double>(memory) / (1 << 20), "MiB"));
  verdict.expect_in_time(live.quantile(neighbours.without_stolen(1)) < 50,
                         "/livez on the operations port within " +
                             with_unit(live.quantile(neighbours.without_stolen(1)), "ms, at most ") +
                             with_unit(live.quantile(1), "ms"),
                         neighbours);
  return verdict.exit_code();
}

}  // namespace remesh::load
