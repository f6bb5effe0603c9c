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

  /// Errors: StoreUnusable.
  void start();
  void begin_drain() { runner_.begin_drain(); }
  bool is_idle() const { return runner_.is_idle(); }
  void stop();

  JobStore& store() { return *store_; }
  /// The common deadline for all calls of a request that begins to use the store now.
  Clock::time_point deadline() const { return Clock::now() + settings_.rules.timeout; }
  bool is_well() const { return store_->is_well(); }
  /// True if the queue has reached its largest permitted length.
  bool is_full() const { return statistics().queued >= settings_.max_queued; }
  /// Counts of the whole store, which may be a second or two old.
  QueueStatistics statistics() const;
  /// The bytes of all inputs and results, as of some seconds ago.
  std::uint64_t stored_bytes() const { return stored_bytes_; }
  /// Tells the runner that a job was submitted in this process, so that the runner need not wait for a notification
  /// from the store.
  void wake() { runner_.wake(); }
  /// Cancels a job in the store and in this process. If the job has ended already, its stored blobs are removed
  /// instead.
  void remove(const std::string& id);

 private:
  void look_after();
  void touch();
  /// Counts and logs the changes that upkeep has made.
  void tell(const Upkeep& done);

  /// The bytes of the jobs' files that are in memory, because their folder is.
  std::uint64_t bytes_in_memory() const;

  const std::unique_ptr<JobStore> store_;
  const JobSettings settings_;
  const bool are_blobs_in_memory_;
  const std::string memory_folder_;  ///< the folder of SQLite's file if it is in memory, else empty
  MemoryBudget& memory_;
  Metrics& metrics_;
  JobRunner runner_;
  mutable std::mutex mutex_;
  QueueStatistics statistics_;
  Clock::time_point next_upkeep_{};
  bool is_stopped_ = false;
  Clock::time_point next_touch_{};
  Clock::time_point next_sum_{};
  std::atomic<std::uint64_t> stored_bytes_{0};
  Clock::time_point next_complaint_{};
  std::optional<Periodic> looks_;
};

}  // namespace remesh::server::jobs
