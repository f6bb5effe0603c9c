/// The jobs that this process works on, and their leases.
#pragma once

#include <atomic>
#include <list>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "server/jobs/job_settings.h"
#include "server/observe/metrics.h"
#include "server/work/memory_budget.h"
#include "server/work/periodic.h"
#include "server/work/request_registry.h"
#include "server/work/worker_pool.h"

namespace remesh::server::jobs {

/// A job that this process works on, from its claim until it is committed, given back or lost.
struct ActiveJob {
  ActiveJob(Claim its_claim, RequestRegistry& registry)
      : claim(std::move(its_claim)), running(registry.add(new_request_id())) {}

  /// Stops work on a job that no longer belongs to this process.
  void lose() {
    is_lost = true;
    running->cancel();
  }

  const Claim claim;
  const RequestRegistry::Entry running;
  std::shared_ptr<MemoryShare> memory;
  std::optional<WorkerPool::Ticket> ticket;  ///< the job's place in the pool's queue; for the thread that claims
  std::atomic<bool> is_computed{false};      ///< its outcome waits for the commit
  std::atomic<bool> is_lost{false};
  std::atomic<bool> is_committing{false};
  std::atomic<Clock::time_point> started{Clock::time_point::max()};
  // These members are for the thread that commits.
  Clock::time_point ended{};  ///< the time at which computing ended
  JobOutcome outcome;
  std::optional<api::WorkDone> done;
  // These members are used by the lease keeper's thread alone.
  Clock::time_point renewed = Clock::now();
  Progress told;
  double of_stage = 0;  ///< the progress within the stage at that time
};

/// Keeps the list of the jobs, renews their leases, and returns jobs to the queue.
class LeaseKeeper {
 public:
  using Jobs = std::list<std::shared_ptr<ActiveJob>>;

  LeaseKeeper(JobStore& store, Metrics& metrics, const RunnerSettings& settings)
      : store_(store), metrics_(metrics), settings_(settings) {}

  /// Renews leases from now on, in a thread of its own. It also ends work that takes too long.
  void start();
  void stop() { renewals_.reset(); }

  void add(std::shared_ptr<ActiveJob> job) {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  void remove(const std::shared_ptr<ActiveJob>& job) {
    const std::lock_guard lock(mutex_);
    jobs_.remove(job);
  }
  Jobs jobs() const {
    const std::lock_guard lock(mutex_);
    return jobs_;
  }
  /// Returns a job to the queue, or later if the store does not answer.
  /// Input: `memory` - as JobStore::give_back.
  void give_back(ActiveJob& job, JobStore::Attempt attempt, const char* reason,
                 std::optional<std::uint64_t> memory = std::nullopt);
  /// Gives back the jobs that could not be given back during an outage of the store.
  void return_late();

 private:
  struct Return {
    Claim claim;
    JobStore::Attempt attempt;
    std::string reason;
    std::optional<std::uint64_t> memory;
  };

  void renew_all();
  /// Errors: StoreError, DataError.
  void renew(ActiveJob& job);
  /// Errors: StoreError.
  void try_to(const Return& give_back);

  JobStore& store_;
  Metrics& metrics_;
  const RunnerSettings& settings_;
  mutable std::mutex mutex_;
  Jobs jobs_;
  std::vector<Return> late_returns_;  ///< claims that could not be given back yet
  std::optional<Periodic> renewals_;
};

}  // namespace remesh::server::jobs
