/// Claims jobs and works on them. It uses the same worker pool, the same memory budget and the same functions as
/// requests that are answered at once.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "api/service.h"
#include "server/jobs/job_settings.h"
#include "server/jobs/job_store.h"
#include "server/observe/metrics.h"
#include "server/work/memory_budget.h"
#include "server/work/periodic.h"
#include "server/work/request_registry.h"
#include "server/work/worker_pool.h"

namespace remesh::server::jobs {

using KeepOperation = std::function<api::StoredRemesh(const api::Request&, const api::Limits&, RunControl&)>;

struct RunnerSettings {
  std::string worker;  ///< the name of this process in the store and in the log
  api::Limits limits;
  std::size_t max_held = 1;  ///< jobs that this process works on at once
  /// Attempts after which a job fails that repeatedly finds no memory or threads.
  int max_attempts = StoreRules().max_attempts;
  std::chrono::milliseconds lease = StoreRules().lease;  ///< renewed when a quarter of it has passed
  /// The longest time that the computation of one job may take.
  std::chrono::milliseconds job_timeout = JobSettings().job_timeout;
  std::chrono::milliseconds store_timeout = StoreRules().timeout;
};

class JobRunner {
 public:
  JobRunner(JobStore& store, WorkerPool& pool, RequestRegistry& registry, MemoryBudget& memory, Metrics& metrics,
            KeepOperation operation, RunnerSettings settings);
  /// Calls `stop`.
  ~JobRunner();

  void start();
  /// Tells the runner that there may be a job to claim.
  void wake() { wake_.set(); }
  /// Stops claiming. Jobs that were claimed before are finished.
  void begin_drain();
  /// True if the runner has no job.
  bool is_idle() const;
  /// Cancels the jobs that still run and returns them to the queue. These attempts do not count. The pool may end
  /// after this.
  void stop();
  /// Stops work on a job that was cancelled in the store. This is sooner than the next renewal would notice it.
  void drop(const std::string& id);

 private:
  struct Held;
  struct Return {
    Claim claim;
    JobStore::Attempt attempt;
    std::string reason;
    std::optional<std::uint64_t> memory;
  };
  enum class Step { kClaimed, kNothing, kNoRoom };

  void claim_until_stopped();
  Step claim_one();
  bool has_room() const;
  /// Looks whether the job that is next in turn waits for memory, and gives it a place in the line for it.
  void look_for_passed_over();
  /// Output: the memory for the next claim; nothing if no job may be claimed now.
  std::optional<std::uint64_t> memory_for_claim();
  /// True if no job may pass the one that is passed over any more.
  bool holds_up_jobs();
  /// Stops claiming for a while, because this daemon lacks the folder that a job's input is in.
  /// Output: false if the job is to fail, since that has happened to it too often.
  bool pause_without_folder(const Claim& claim);
  /// Input: `share` - memory that was reserved for this job, or null.
  void hold(Claim claim, std::shared_ptr<MemoryShare> share);
  void renew_all();
  void renew(Held& held);
  /// Gives back what could not be given back while the store was away.
  void return_late();
  /// Errors: StoreError.
  void try_to(const Return& give_back);
  void run(const std::shared_ptr<Held>& held);
  /// Output: nothing if the job has no outcome here, because its claim was lost or it goes back to the queue.
  std::optional<JobOutcome> work_on(Held& held);
  std::optional<JobOutcome> outcome_of_failure(Held& held, const std::exception_ptr& failure);
  void commit_until_stopped();
  /// Output: false if the store did not answer and the same should be tried again.
  bool commit(Held& held, JobOutcome& outcome);
  /// Returns what is stored in place of an outcome that the store cannot take.
  /// Input: `reason` - what the store said, for the log.
  static JobOutcome unstorable(const Held& held, const HttpError& told, std::string reason);
  static void log_end(const Held& held, const JobOutcome& outcome, std::string_view event);
  /// Input: `memory` - as JobStore::give_back.
  void give_back(Held& held, JobStore::Attempt attempt, const char* reason,
                 std::optional<std::uint64_t> memory = std::nullopt);
  void release(const std::shared_ptr<Held>& held);
  std::list<std::shared_ptr<Held>> held() const;

  JobStore& store_;
  WorkerPool& pool_;
  RequestRegistry& registry_;
  MemoryBudget& memory_;
  Metrics& metrics_;
  const KeepOperation operation_;
  const RunnerSettings settings_;
  Event wake_;
  std::atomic<bool> draining_{false};
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  std::list<std::shared_ptr<Held>> held_;
  /// Finished jobs that wait for their commit. A thread of its own commits them, so that the next job need not wait
  /// for the store.
  std::deque<std::pair<std::shared_ptr<Held>, JobOutcome>> done_;
  std::condition_variable done_changed_;
  std::vector<Return> late_returns_;  ///< claims that could not be given back yet
  bool committer_may_end_ = false;
  std::atomic<std::size_t> claiming_{0};
  std::atomic<Clock::time_point> next_claims_{Clock::time_point::min()};  ///< no job is claimed before
  std::map<std::string, int> pauses_;  ///< how often claiming was stopped because of a job; guarded by `mutex_`
  // The claiming thread alone uses what follows.
  /// The job that is next in turn and finds no memory, and its place in the line.
  struct PassedOver {
    WaitingJob job;
    Clock::time_point since;
    std::shared_ptr<MemoryShare> share;
    std::optional<Clock::time_point> alone_since;  ///< since when only requests are in its way, and no job may pass
    Clock::time_point others_until;                ///< other jobs pass until then
  };
  std::optional<PassedOver> passed_over_;
  Clock::time_point next_look_{};
  /// The last claim that found no job for the memory that there was, and when it may be repeated with no more memory.
  struct EmptyClaim {
    std::uint64_t room;
    Clock::time_point again;
  };
  std::optional<EmptyClaim> empty_claim_;
  std::optional<Periodic> renewals_;
  std::thread claimer_;
  std::thread committer_;
};

}  // namespace remesh::server::jobs
