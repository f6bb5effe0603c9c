/// Judges which workers have died, without trusting any clock but this process's own.
///
/// A worker that lives changes its job's row often. The judge reads the rows and stores when it first saw each version.
/// A row that stays the same for a whole lease belongs to a dead worker. Only time in which the store could be written
/// counts: during an outage, no worker can give a sign of life. So neither an outage nor a change of a clock takes a
/// job from a living worker.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "server/http/connection.h"

namespace remesh::server::jobs {

class LeaseJudge {
 public:
  /// Input: `max_pause` - the longest pause between two calls that counts in full. During a longer pause, this process
  ///        itself was stopped or had no processor time, and the same may be true of the workers.
  explicit LeaseJudge(std::chrono::milliseconds max_pause) : max_pause_(max_pause) {}

  /// The part of a running job's row that shows whether its worker lives.
  struct Sign {
    std::string id;
    std::int64_t token = 0;
    std::int64_t version = 0;
    std::chrono::milliseconds lease{0};  ///< the lease under which its worker has claimed it
  };

  /// Records that a write reached the store.
  /// Input: the times of the question and of the answer.
  void record_reached(Clock::time_point asked, Clock::time_point answered);
  /// Records that a write did not reach the store.
  void record_failed();
  /// Records a sign of life that this process itself caused.
  void see(const Sign& sign);
  /// Judges all running jobs.
  /// Input:  all jobs that are running now; jobs that are missing here are forgotten.
  /// Output: the jobs whose lease has run out.
  std::vector<Sign> judge(const std::vector<Sign>& running);

 private:
  struct Seen {
    std::int64_t token;
    std::int64_t version;
    std::chrono::milliseconds lease;
    Clock::duration at;  ///< the time, as `counted_` counts it
  };
  /// Output: true if the sign is older than its lease.
  bool record_locked(const Sign& sign);

  const std::chrono::milliseconds max_pause_;
  std::mutex mutex_;
  Clock::duration counted_{0};  ///< the time in which the store could be written
  Clock::time_point last_answer_{};
  bool is_reached_ = false;  ///< false after a failure, until the next answer
  std::map<std::string, Seen, std::less<>> seen_;
};

}  // namespace remesh::server::jobs
