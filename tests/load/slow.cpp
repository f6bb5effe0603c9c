#include <atomic>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/load/client.h"
#include "tests/load/scenarios.h"
#include "tests/server/daemon_process.h"
#include "tests/server/raw_client.h"
#include "tests/server/small_meshes.h"

namespace remesh::load {
namespace {

using server::RawClient;
using Clients = std::vector<std::unique_ptr<RawClient>>;

/// Sends one byte on each sender, and takes one from each reader, every two seconds while `goes_on`.
void trickle(const Clients& senders, const Clients& readers, const std::atomic<bool>& goes_on) {
  while (goes_on) {
    for (const auto& client : senders) client->send("a");
    for (const auto& client : readers) client->receive_byte();
    for (int i = 0; i < 20 && goes_on; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

double usual_ms(int port, const std::string& request, int times) {
  Times all;
  for (int i = 0; i < times; ++i) all.add(perform(port, request).ms);
  return all.quantile(0.5);
}

}  // namespace

int slow(std::size_t connections, bool judges_times) {
  const server::DaemonProcess daemon({"--max-connections", "2000", "--max-connections-per-address", "2000",
                                      "--queue-size", "1000", "--ops-bind", "127.0.0.1:0", "--head-timeout", "1000s",
                                      "--write-timeout", "1000s"});
  const int port = daemon.port();
  const std::string real = post_text("/v1/remesh?refine=false", server::bumpy_sheet(40));
  const double usual = usual_ms(port, real, 5);

  Clients senders;
  for (std::size_t i = 0; i < connections; ++i) {
    senders.push_back(std::make_unique<RawClient>(port));
    // Half of them are slow in the head, and half in the body.
    senders.back()->send(i % 2 == 0 ? "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nX-Slow: "
                                    : "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n\r\n");
  }
  // The answers are too large for the buffers on the way, and these clients hardly read.
  const std::string large = post_text("/v1/remesh?refine=false&format=json", server::bumpy_sheet(15));
  Clients readers;
  const std::string connected = "remeshd_http_connections";
  const auto has_worked_for = [&](std::size_t clients) {
    for (int i = 0; i < 12'000; ++i) {
      const std::string metrics = fetch(daemon.ops_port(), "/metrics");
      // A connection that waits to be accepted has no request that is queued or runs.
      if (metric(metrics, connected) >= static_cast<double>(clients) &&
          metric(metrics, "remeshd_requests_queued") == 0 && metric(metrics, "remeshd_requests_running") == 0)
        return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  };
  // A few at a time, because requests that a busy machine cannot begin soon are refused, and their connections closed.
  constexpr std::size_t kAtOnce = 16;
  for (std::size_t i = 0; i < connections; ++i) {
    readers.push_back(std::make_unique<RawClient>(port, "127.0.0.1", /*receive_buffer=*/4096));
    readers.back()->send(large);
    const bool is_last_of_some = (i + 1) % kAtOnce == 0 || i + 1 == connections;
    if (is_last_of_some && !has_worked_for(connections + i + 1)) break;
  }

  std::atomic<bool> goes_on = true;
  std::thread slow_ones([&] { trickle(senders, readers, goes_on); });
  const double held = metric(fetch(daemon.ops_port(), "/metrics"), connected);
  Times live;
  Times ops;
  Times work;
  int unanswered = 0;
  // The slow clients stay for longer than these wait for their answer.
  const auto measure = [&](Times& times, int asked, const std::string& request) {
    const Outcome outcome = perform(asked, request);
    times.add(outcome.ms);
    unanswered += outcome.status == 200 ? 0 : 1;
  };
  const Neighbours neighbours(daemon.pid());
  for (int i = 0; i < 40; ++i) {
    measure(live, port, get_text("/livez"));
    measure(ops, daemon.ops_port(), get_text("/livez"));
    if (i % 4 == 0) measure(work, port, real);
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  goes_on = false;
  slow_ones.join();

  Verdict verdict(judges_times);
  std::printf("%zu slow senders, %zu slow readers; a request usually takes %.1f ms\n", connections, connections, usual);
  verdict.expect(held >= static_cast<double>(2 * connections),
                 "all slow connections are held open: " + with_unit(held, "connections"));
  verdict.expect(unanswered == 0, "every other request is answered");
  verdict.expect_in_time(live.quantile(1) < 50,
                         "/livez answers within 50 ms: at most " + with_unit(live.quantile(1), "ms"), neighbours);
  verdict.expect_in_time(ops.quantile(1) < 50,
                         "and on the operations port: at most " + with_unit(ops.quantile(1), "ms"), neighbours);
  verdict.expect_in_time(work.quantile(1) < usual + 1000,
                         "a real request takes at most a second more: at most " + with_unit(work.quantile(1), "ms"),
                         neighbours);
  std::printf("memory: %.0f MiB\n", static_cast<double>(daemon.memory("VmRSS")) / (1 << 20));
  return verdict.exit_code();
}

}  // namespace remesh::load
