#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "tests/load/client.h"
#include "tests/load/scenarios.h"
#include "tests/server/daemon_process.h"
#include "tests/server/small_meshes.h"

namespace remesh::load {
namespace {

enum class Kind { kGood, kBroken, kCut };

struct Sample {
  Kind kind;
  std::string bytes;
};

std::vector<Sample> samples() {
  const std::string& frame = server::kFrame;
  const std::string head = "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\n";
  const std::string chunked = head + "Transfer-Encoding: chunked\r\n\r\n";
  return {
      {Kind::kGood, post_text("/v1/remesh", frame)},
      {Kind::kGood, post_text("/v1/remesh?format=json", frame)},
      {Kind::kGood, post_text("/v1/analyze", frame)},
      {Kind::kGood, post_text("/v1/remesh?refine=false", server::bumpy_sheet(6))},
      {Kind::kGood, get_text("/v1/capabilities")},
      {Kind::kGood, get_text("/openapi.json")},
      {Kind::kGood, get_text("/readyz")},
      {Kind::kGood, chunked + "4\r\nv 0 \r\n0\r\n\r\n"},
      {Kind::kBroken, post_text("/v1/remesh", frame + "f 1 2 99\n")},
      {Kind::kBroken, post_text("/v1/remesh?refin=true", frame)},
      {Kind::kBroken, "GET /livez HTTP/1.1\nHost: localhost\n\n"},
      {Kind::kBroken, chunked + "0x5\r\nhello\r\n0\r\n\r\n"},
      {Kind::kBroken, head + "\r\n"},
      {Kind::kBroken, get_text("/nowhere")},
      {Kind::kCut, post_text("/v1/remesh?max_edge_fraction=0.02", frame)},
      {Kind::kCut, head + "Content-Length: 5000\r\n\r\nv 0 0 0\n"},
      {Kind::kCut, get_text("/openapi.json")},
  };
}

/// Returns the n-th request. A tenth of all requests are broken, and a tenth are cut off.
const Sample& choose(const std::vector<Sample>& all, std::size_t n) {
  const Kind kind = n % 10 == 3 ? Kind::kBroken : n % 10 == 7 ? Kind::kCut : Kind::kGood;
  std::size_t skip = n / 10;
  for (std::size_t i = 0;; i = (i + 1) % all.size()) {
    if (all[i].kind == kind && skip-- % 8 == 0) return all[i];
  }
}

double all_requests(const std::string& metrics) {
  double sum = 0;
  for (std::size_t at = metrics.find("\nremeshd_http_requests_total{"); at != std::string::npos;
       at = metrics.find("\nremeshd_http_requests_total{", at + 1))
    sum += std::stod(metrics.substr(metrics.find("} ", at) + 2));
  return sum;
}

double with_code(const std::string& metrics, int code) {
  const std::string label = "code=\"" + std::to_string(code) + "\"";
  double sum = 0;
  for (std::size_t at = metrics.find("\nremeshd_http_requests_total{" + label); at != std::string::npos;
       at = metrics.find("\nremeshd_http_requests_total{" + label, at + 1))
    sum += std::stod(metrics.substr(metrics.find("} ", at) + 2));
  return sum;
}

/// The resources that the daemon occupies once all is quiet.
struct Holding {
  double memory_mib = 0;
  std::size_t descriptors = 0;
};

/// Returns the least of ten counts. A descriptor that stays open is in all of them. The file in which the daemon reads
/// its own memory is not, because it is open only for a moment again and again.
std::size_t descriptors_held(const server::DaemonProcess& daemon) {
  std::size_t least = daemon.descriptors();
  for (int look = 1; look < 10; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(7));
    least = std::min(least, daemon.descriptors());
  }
  return least;
}

Holding measure(const server::DaemonProcess& daemon) {
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  return {static_cast<double>(daemon.memory("VmRSS")) / (1 << 20), descriptors_held(daemon)};
}

}  // namespace

int soak(std::size_t requests) {
  server::DaemonProcess daemon({"--ops-bind", "127.0.0.1:0", "--log-level", "info"});
  const std::vector<Sample> all = samples();
  std::array<std::atomic<std::size_t>, 600> answered{};
  std::atomic<std::size_t> cut = 0;
  std::atomic<std::size_t> lost = 0;
  std::size_t done = 0;
  const auto run_until = [&](std::size_t end) {
    std::atomic<std::size_t> next = done;
    in_parallel(8, [&](std::size_t) {
      for (std::size_t n = next++; n < end; n = next++) {
        const Sample& sample = choose(all, n);
        if (sample.kind == Kind::kCut) {
          send_and_leave(daemon.port(), sample.bytes);
          ++cut;
          continue;
        }
        const int status = perform(daemon.port(), sample.bytes).status;
        if (status == 0) ++lost;
        ++answered[static_cast<std::size_t>(status)];
      }
    });
    done = end;
  };

  const Clock::time_point start = Clock::now();
  // Caches and the arenas of all threads take memory once. This is no growth, so measuring begins after it.
  constexpr std::size_t kWarm = 5000;
  const std::size_t warm = std::max(requests / 5, std::min(requests / 2, kWarm));
  run_until(warm);
  const Holding before = measure(daemon);
  // A leak grows in every stage. An arena that grows once, because many requests happened to meet, does not. Thus the
  // median of the stages is judged.
  constexpr std::size_t kStages = 5;
  Holding after = before;
  std::array<double, kStages> growths{};
  for (std::size_t stage = 0; stage < kStages; ++stage) {
    run_until(warm + (stage + 1) * (requests - warm) / kStages);
    const double last = std::exchange(after, measure(daemon)).memory_mib;
    growths[stage] = after.memory_mib - last;
  }
  std::nth_element(growths.begin(), growths.begin() + kStages / 2, growths.end());
  const double growth = 100 * kStages * growths[kStages / 2] / before.memory_mib;
  // On a busy machine, the last connections of clients that have left are closed late, and their requests counted then.
  std::string metrics = fetch(daemon.ops_port(), "/metrics");
  for (int look = 0; look < 120; ++look) {
    if (after.descriptors <= before.descriptors && all_requests(metrics) == static_cast<double>(requests)) break;
    std::this_thread::sleep_for(std::chrono::seconds(1));
    after.descriptors = descriptors_held(daemon);
    metrics = fetch(daemon.ops_port(), "/metrics");
  }

  Verdict verdict(/*judges_times=*/false);
  std::printf("%zu requests in %.0f s, %zu cut off\n", requests,
              std::chrono::duration<double>(Clock::now() - start).count(), cut.load());
  verdict.expect(lost == 0, "no request without an answer");
  verdict.expect(growth < 5, "memory: " + with_unit(before.memory_mib, "MiB, then ") +
                                 with_unit(after.memory_mib, "MiB: by the median of the stages ") +
                                 with_unit(growth, "% more"));
  verdict.expect(after.descriptors <= before.descriptors,
                 "descriptors: " + std::to_string(before.descriptors) + ", then " + std::to_string(after.descriptors));
  verdict.expect(all_requests(metrics) == static_cast<double>(requests),
                 "/metrics counts all: " + with_unit(all_requests(metrics), "requests"));
  for (std::size_t code = 200; code < answered.size(); ++code) {
    if (answered[code] == 0) continue;
    const double counted = with_code(metrics, static_cast<int>(code));
    // The daemon may have answered a request before it could know that the client had cut it off.
    const bool may_be_more = code == 200 || code == 400;
    const auto seen = static_cast<double>(answered[code]);
    verdict.expect(may_be_more ? counted >= seen && counted <= seen + static_cast<double>(cut) : counted == seen,
                   "status " + std::to_string(code) + ": " + with_unit(seen, "seen, ") + with_unit(counted, "counted"));
  }
  daemon.send_signal(SIGTERM);
  verdict.expect(daemon.wait() == 0, "it stops with exit code 0");
  return verdict.exit_code();
}

}  // namespace remesh::load
