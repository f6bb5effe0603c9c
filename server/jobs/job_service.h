/// Jobs put together: the store, who works on it here, and what time brings.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "server/jobs/job_runner.h"
#include "server/jobs/job_settings.h"
#include "server/jobs/job_store.h"
#include "server/work/periodic.h"

namespace remesh::server::jobs {

/// Opens the store that the settings name; nothing where there is none. Errors: std::invalid_argument - no such store.
std::unique_ptr<JobStore> open_store(const JobSettings& settings, Metrics& metrics);

class JobService {
 public:
  /// Refers to all of these; they outlive it, but for the pool, which ends between `stop` and its end.
  JobService(std::unique_ptr<JobStore> store, const JobSettings& settings, RunnerSettings runner, WorkerPool& pool,
             RequestRegistry& registry, MemoryBudget& memory, Metrics& metrics, KeepOperation operation);

  void start();
  void begin_drain();
  bool is_idle() const { return runner_.is_idle(); }
  void stop();

  JobStore& store() { return *store_; }
  bool is_well() const { return store_->is_well(); }
  /// Whether as many jobs wait as may.
  bool is_full() const { return statistics().queued >= settings_.max_queued; }
  /// As of a second or two ago.
  QueueStatistics statistics() const;
  /// A job was submitted here: no need to wait for the store to say so.
  void wake();
  /// Cancels a job, in the store and here; of one that has ended it removes what is kept.
  void remove(const std::string& id);

 private:
  void look_after();

  const std::unique_ptr<JobStore> store_;
  const JobSettings settings_;
  Metrics& metrics_;
  JobRunner runner_;
  mutable std::mutex mutex_;
  QueueStatistics statistics_;
  Clock::time_point next_upkeep_{};
  Clock::time_point next_touch_{};
  bool was_well_ = true;
  std::optional<Periodic> looks_;
};

}  // namespace remesh::server::jobs
