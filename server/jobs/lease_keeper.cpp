#include "server/jobs/lease_keeper.h"

#include <algorithm>

#include "server/jobs/store_deadline.h"
#include "server/observe/log.h"

namespace remesh::server::jobs {
namespace {

constexpr std::chrono::milliseconds kMaxBetweenLooks{1000};

}  // namespace

void LeaseKeeper::start() {
  renewals_.emplace(std::min(kMaxBetweenLooks, settings_.rules.lease / 8), [this] { renew_all(); });
}

void LeaseKeeper::renew_all() {
  // If one row is locked, the other leases must still be renewed in time.
  const SharedStoreDeadline deadline(Clock::now() + settings_.rules.timeout);
  return_late();
  for (const std::shared_ptr<ActiveJob>& job : jobs()) {
    if (job->started.load() <= Clock::now() - settings_.job_timeout) job->running->control.expire();
    try {
      renew(*job);
    } catch (const StoreError&) {
      // The store's observer has logged the error. The lease does not age during an outage of the store.
    } catch (const DataError& error) {
      log::write(log::Level::kError, "cannot renew a lease",
                 {{"job", job->claim.id}, {"error", std::string(error.what())}});
    }
  }
}

void LeaseKeeper::return_late() {
  std::vector<Return> late;
  {
    const std::lock_guard lock(mutex_);
    late.swap(late_returns_);
  }
  while (!late.empty()) {
    try {
      try_to(late.back());
      late.pop_back();
    } catch (const StoreError&) {
      const std::lock_guard lock(mutex_);
      late_returns_.insert(late_returns_.end(), late.begin(), late.end());
      return;
    }
  }
}

void LeaseKeeper::renew(ActiveJob& job) {
  if (job.is_lost || job.is_committing) return;
  const RunControl& control = job.running->control;
  // The progress of the whole run may stand still while a stage goes on, so it does not show alone that there is work.
  const Progress now{std::string(stage_name(control.stage())), job.running->overall.look(control)};
  const double of_stage = control.fraction();
  const bool is_due = Clock::now() - job.renewed >= settings_.rules.lease / 4;
  const bool has_moved = now.stage != job.told.stage || of_stage != job.of_stage;
  const Clock::time_point asked = Clock::now();
  if (is_due || has_moved ? store_.renew(job.claim, now) : store_.holds(job.claim)) {
    if (is_due || has_moved) job.renewed = asked;
    job.told = now;
    job.of_stage = of_stage;
    return;
  }
  if (job.is_committing) return;  // this claim itself has ended the job
  log::write(log::Level::kInfo, "job lost", {{"job", job.claim.id}, {"token", job.claim.token}});
  job.lose();
}

void LeaseKeeper::give_back(ActiveJob& job, JobStore::Attempt attempt, const char* reason,
                            std::optional<std::uint64_t> memory) {
  job.is_committing = true;
  const Return wanted{job.claim, attempt, reason, memory};
  try {
    try_to(wanted);
  } catch (const StoreError&) {
    const std::lock_guard lock(mutex_);
    late_returns_.push_back(wanted);
  }
}

void LeaseKeeper::try_to(const Return& give_back) {
  const Claim& claim = give_back.claim;
  try {
    const bool is_back = store_.give_back(claim, give_back.attempt, give_back.memory);
    log::write(log::Level::kInfo, is_back ? "job given back" : "job lost",
               {{"job", claim.id}, {"token", claim.token}, {"reason", give_back.reason}});
    if (is_back) metrics_.count_job_retry(give_back.reason);
  } catch (const DataError& error) {
    log::write(log::Level::kError, "cannot give a job back", {{"job", claim.id}, {"error", std::string(error.what())}});
  }
}

}  // namespace remesh::server::jobs
