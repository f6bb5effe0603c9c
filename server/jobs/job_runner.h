/// Claims jobs and works on them. It uses the same worker pool, the same memory budget and the same functions as
/// requests that are answered at once.
#pragma once

#include <exception>
#include <functional>
#include <map>

#include "server/jobs/job_claimer.h"
#include "server/jobs/job_committer.h"
#include "server/jobs/lease_keeper.h"

namespace remesh::server::jobs {

using KeepOperation = std::function<api::StoredRemesh(const api::Request&, const api::Limits&, RunControl&)>;

/// One thread claims jobs (`JobClaimer`), the pool works on them, another thread commits their outcomes
/// (`JobCommitter`), and a third thread renews their leases meanwhile (`LeaseKeeper`).
class JobRunner {
 public:
  JobRunner(JobStore& store, WorkerPool& pool, RequestRegistry& registry, MemoryBudget& memory, Metrics& metrics,
            KeepOperation operation, RunnerSettings settings);
  /// Calls `stop`.
  ~JobRunner();

  void start();
  /// Tells the runner that there may be a job to claim.
  void wake() { claimer_.wake(); }
  /// Stops claiming. Jobs that were claimed before are finished.
  void begin_drain() { claimer_.begin_drain(); }
  /// True if the runner has no job. A job that is being claimed counts.
  bool is_idle() const { return !claimer_.is_claiming() && leases_.jobs().empty(); }
  /// Cancels the jobs that still run and returns them to the queue. These attempts do not count. The pool may end
  /// after this.
  void stop();
  /// Stops work on a job that was cancelled in the store. The next renewal would notice the cancellation only later.
  void drop(const std::string& id);

 private:
  bool has_room() const;
  /// Begins work on a job that was claimed.
  /// Input: `share` - memory that was reserved for this job, or null.
  void begin(Claim claim, std::shared_ptr<MemoryShare> share);
  void run(const std::shared_ptr<ActiveJob>& job);
  void release(const std::shared_ptr<ActiveJob>& job);
  /// Output: nothing if the job has no outcome in this process, because its claim was lost or it goes back to the
  ///         queue.
  std::optional<JobOutcome> work_on(ActiveJob& job);
  std::optional<JobOutcome> outcome_of_failure(ActiveJob& job, std::exception_ptr failure);
  /// Stops claiming for a while, because this daemon lacks the folder of a job's input.
  /// Output: false if the job is to fail, because it has caused too many such pauses.
  bool pause_without_folder(const Claim& claim);

  JobStore& store_;
  WorkerPool& pool_;
  RequestRegistry& registry_;
  MemoryBudget& memory_;
  Metrics& metrics_;
  const KeepOperation operation_;
  const RunnerSettings settings_;
  std::mutex mutex_;
  std::map<std::string, int> pauses_;  ///< by job: how often it has stopped claiming; guarded by `mutex_`
  LeaseKeeper leases_;
  JobCommitter committer_;
  JobClaimer claimer_;
  bool is_stopped_ = false;
};

}  // namespace remesh::server::jobs
