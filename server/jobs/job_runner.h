/// Claims jobs and works on them: on the same pool, under the same memory budget and through the same functions as the
/// requests that are answered at once.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "api/service.h"
#include "server/jobs/job_store.h"
#include "server/observe/metrics.h"
#include "server/work/memory_budget.h"
#include "server/work/periodic.h"
#include "server/work/request_registry.h"
#include "server/work/worker_pool.h"

namespace remesh::server::jobs {

using KeepOperation = std::function<api::KeptRemesh(const api::Request&, const api::Limits&, RunControl&)>;

struct RunnerSettings {
  std::string worker;  ///< what this process is called in the store and the log
  api::Limits limits;
  std::size_t max_held = 1;                          ///< jobs at once
  int max_attempts = 3;                              ///< of those that find no memory
  std::chrono::milliseconds lease{60'000};           ///< renewed at a quarter of it
  std::chrono::milliseconds job_timeout{3'600'000};  ///< of computing
};

class JobRunner {
 public:
  JobRunner(JobStore& store, WorkerPool& pool, RequestRegistry& registry, MemoryBudget& memory, Metrics& metrics,
            KeepOperation operation, RunnerSettings settings);
  /// Stops.
  ~JobRunner();

  void start();
  /// There may be something to claim.
  void wake() { wake_.set(); }
  /// Claims nothing more; what it has is finished.
  void begin_drain();
  /// Whether it has nothing.
  bool is_idle() const;
  /// Cancels what still runs and gives it back to the queue, none the worse. Then the pool may end.
  void stop();
  /// Ends a job that runs here and was cancelled in the store: sooner than its next renewal would.
  void drop(const std::string& id);

 private:
  struct Held;
  enum class Step { kClaimed, kNothing, kNoRoom };

  void claim_until_stopped();
  Step claim_one();
  bool has_room() const;
  void hold(Claim claim);
  void renew_all();
  void renew(Held& held);
  void run(const std::shared_ptr<Held>& held);
  /// Output: nothing where the job has no outcome here: it was lost, or goes back.
  std::optional<JobOutcome> work_on(Held& held);
  std::optional<JobOutcome> outcome_of_failure(Held& held, const std::exception_ptr& failure);
  void commit_until_stopped();
  void commit(Held& held, const JobOutcome& outcome);
  static void log_end(const Held& held, const JobOutcome& outcome, std::string_view event);
  void give_back(Held& held, JobStore::Attempt attempt, const char* reason);
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
  /// Jobs that are done: committed by a thread of its own, so that the next one need not wait for the store.
  std::deque<std::pair<std::shared_ptr<Held>, JobOutcome>> done_;
  std::condition_variable done_changed_;
  bool committer_may_end_ = false;
  std::atomic<std::size_t> claiming_{0};
  std::optional<Periodic> renewals_;
  std::thread claimer_;
  std::thread committer_;
};

}  // namespace remesh::server::jobs
