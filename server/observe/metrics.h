/// The daemon's counters and their text in Prometheus's format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "api/operations.h"

namespace remesh::server {

/// Values that are read when `/metrics` is requested, and so need no counting.
struct Gauges {
  std::size_t connections = 0;
  std::size_t running = 0;
  std::size_t queued = 0;
  int workers = 0;
  std::size_t busy = 0;
  std::uint64_t memory_reserved = 0;
  std::size_t memory_waiting = 0;
  std::uint64_t log_lines_dropped = 0;
  bool is_ready = false;
  bool has_jobs = false;  ///< true if the following members are known
  std::int64_t jobs_queued = 0;
  std::int64_t jobs_running = 0;
  double job_oldest_queued_s = 0;
  std::uint64_t jobs_stored_bytes = 0;
};

/// All members may be called from any thread. The number of label values is bounded, whatever clients send.
class Metrics {
 public:
  Metrics();
  ~Metrics();

  /// Counts a request that is over.
  /// Input: `route` - the path of the route with `{id}` for the variable part, or "none"; `status` - 499 if the
  ///        client left before its answer; `method` - any text.
  void count_request(std::string_view route, std::string_view method, int status, double seconds);
  /// Counts a request that a limit refused.
  /// Input: `reason` - the `code` of its problem.
  void count_rejection(const std::string& reason);
  void count_work(const api::WorkDone& done);
  /// Counts a request of an API key.
  /// Input: `key` - the key's name; `seconds` - how long the request has computed.
  void count_key(const std::string& key, int status, double seconds);
  /// Counts jobs that have ended.
  /// Input: `outcome` - their state; `code` - the problem's code for failed jobs; `times` - how many.
  void count_job(std::string_view outcome, std::string_view code = {}, int times = 1);
  /// Counts jobs that go back to the queue.
  void count_job_retry(std::string_view reason, int times = 1);
  void count_store(std::string_view op, double seconds, bool failed);

  /// The text of `GET /metrics`.
  std::string text(const Gauges& gauges) const;

 private:
  struct Families;
  const std::unique_ptr<Families> families_;
};

}  // namespace remesh::server
