/// The parts of the job service put together: the store, the runner that works on jobs here, and regular upkeep.
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

/// Opens the store that the settings name.
/// Output: null if they name none, or if no folder for SQLite's file can be written.
/// Errors: std::invalid_argument - the store's address is not valid.
std::unique_ptr<JobStore> open_store(const JobSettings& settings, Metrics& metrics);

class JobService {
 public:
  /// Keeps references to all of these arguments, which must outlive it. The pool is the exception: it must end after
  /// `stop` and before the destructor.
  JobService(std::unique_ptr<JobStore> store, const JobSettings& settings, RunnerSettings runner, WorkerPool& pool,
             RequestRegistry& registry, MemoryBudget& memory, Metrics& metrics, KeepOperation operation);

  void start();
  void begin_drain();
  bool is_idle() const { return runner_.is_idle(); }
  void stop();

  JobStore& store() { return *store_; }
  bool is_well() const { return store_->is_well(); }
  /// True if the queue has reached its largest permitted length.
  bool is_full() const { return statistics().queued >= settings_.max_queued; }
  /// Counts of the whole store, which may be a second or two old.
  QueueStatistics statistics() const;
  /// Tells the runner that a job was submitted here, so that it need not wait for the store to say so.
  void wake();
  /// Cancels a job in the store and here. If the job has ended already, its stored blobs are removed instead.
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
