/// Logs when the store stops answering and when it answers again, without filling the log meanwhile.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string_view>

#include "server/http/connection.h"
#include "server/jobs/job_store.h"

namespace remesh::server::jobs {

class OutageLog {
 public:
  /// At most one warning is written in this period.
  static constexpr std::chrono::minutes kPeriod{1};

  /// Records the outcome of a call of the store.
  /// Input: `error` - null if the call succeeded.
  void note(std::string_view op, const StoreError* error);

 private:
  std::mutex mutex_;
  bool is_away_ = false;     ///< a warning was written, and the store has not answered since then
  std::int64_t failed_ = 0;  ///< number of calls that failed since the last warning
  Clock::time_point next_warning_{};
};

}  // namespace remesh::server::jobs
