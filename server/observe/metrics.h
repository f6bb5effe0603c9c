/// What the daemon counts, in the form that Prometheus reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "api/service.h"

namespace remesh::server {

/// What is asked for at the time of a look and need not be counted.
struct Gauges {
  std::size_t connections = 0;
  std::size_t running = 0;
  std::size_t queued = 0;
  int workers = 0;
  std::size_t busy = 0;
  std::uint64_t memory_reserved = 0;
  bool is_ready = false;
  bool has_jobs = false;  ///< whether the next ones are known
  std::int64_t jobs_queued = 0;
  std::int64_t jobs_running = 0;
  double job_oldest_queued_s = 0;
};

/// All members may be called from any thread. Labels take few values only, whatever clients send.
class Metrics {
 public:
  Metrics();
  ~Metrics();

  /// A request is over. `route`: its path with names for what varies, or "none"; `status`: 499 where the client left
  /// before its answer; `method`: any.
  void count_request(std::string_view route, std::string_view method, int status, double seconds);
  /// One was turned away by a limit, for the reason that its problem has as `code`.
  void count_rejection(const std::string& reason);
  void count_work(const api::WorkDone& done);
  /// A job has ended as its state says, of a failure with that code; `times`: so many of them.
  void count_job(std::string_view outcome, std::string_view code = {}, int times = 1);
  /// One goes back to the queue.
  void count_job_retry(std::string_view reason, int times = 1);
  void count_store(std::string_view op, double seconds, bool failed);

  /// The text of `GET /metrics`.
  std::string text(const Gauges& gauges) const;

 private:
  struct Families;
  const std::unique_ptr<Families> families_;
};

}  // namespace remesh::server
