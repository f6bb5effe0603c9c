#include "server/jobs/job_committer.h"

#include <exception>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/error_response.h"
#include "server/http/exchange.h"
#include "server/observe/log.h"

namespace remesh::server::jobs {
namespace {

/// The pause between two attempts to commit while the store does not answer or has no room.
constexpr std::chrono::milliseconds kWithoutStore{250};
/// How long a result waits for room in the store before its job fails. Until then, the memory of the result is not
/// available to other work.
constexpr std::chrono::minutes kRoomPatience{15};

/// Returns the outcome to store if the store cannot take the original one.
/// Input: `reason` - the store's error message, for the log.
JobOutcome unstorable(const ActiveJob& job, const HttpError& told, std::string reason) {
  log::write(log::Level::kError, "the job store cannot take the outcome of a job",
             {{"job", job.claim.id}, {"error", std::move(reason)}});
  Response problem = error_response(std::make_exception_ptr(told), job.claim.id);
  return JobOutcome{
      JobState::kFailed, "", "", problem.status, std::move(problem.body), std::move(problem.problem_code)};
}

void log_end(const ActiveJob& job, std::string_view event) {
  const JobOutcome& outcome = job.outcome;
  std::vector<log::Field> fields{{"job", job.claim.id},
                                 {"token", job.claim.token},
                                 {"state", std::string(state_name(outcome.state))},
                                 {"work_ms", milliseconds_between(job.started.load(), job.ended)}};
  if (!outcome.problem_code.empty()) fields.push_back({"code", outcome.problem_code});
  if (job.done) add_work(*job.done, fields);
  log::write(log::Level::kInfo, event, fields);
}

}  // namespace

void JobCommitter::add(std::shared_ptr<ActiveJob> job) {
  {
    const std::lock_guard lock(mutex_);
    job->is_computed = true;
    computed_.push_back(std::move(job));
  }
  changed_.notify_one();
}

std::size_t JobCommitter::waiting() const {
  const std::lock_guard lock(mutex_);
  return computed_.size();
}

void JobCommitter::join() {
  {
    const std::lock_guard lock(mutex_);
    may_end_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void JobCommitter::commit_until_joined() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return may_end_ || !computed_.empty(); });
    if (computed_.empty()) return;
    const std::shared_ptr<ActiveJob> job = computed_.front();
    computed_.pop_front();
    lock.unlock();
    bool is_settled = true;
    try {
      is_settled = commit(*job);
    } catch (const std::exception& error) {
      log::write(log::Level::kError, "job left", {{"job", job->claim.id}, {"error", std::string(error.what())}});
    }
    if (is_settled) {
      release_(job);
      lock.lock();
      continue;
    }
    // The result stays in memory until the store is back or the process ends. Meanwhile other outcomes are tried.
    std::this_thread::sleep_for(kWithoutStore);
    lock.lock();
    computed_.push_back(job);
  }
}

bool JobCommitter::commit(ActiveJob& job) {
  JobOutcome& outcome = job.outcome;
  for (bool was_replaced = false;;) {
    try {
      job.is_committing = true;
      const bool is_done = store_.commit(job.claim, outcome);
      log_end(job, is_done ? "job committed" : "job refused");
      if (is_done) metrics_.count_job(state_name(outcome.state), outcome.problem_code);
      return true;
    } catch (const StoreFull& error) {
      job.is_committing = false;
      const bool is_result = outcome.state == JobState::kSucceeded;
      if (!is_result || Clock::now() < job.ended + kRoomPatience) return stopping_ || job.is_lost;
      outcome = unstorable(job, HttpError(507, "storage_full", "the store had no room for the result of this job"),
                           error.what());
    } catch (const StoreError&) {
      job.is_committing = false;
      return stopping_ || job.is_lost;
    } catch (const DataError& error) {
      // The same attempt would fail again, so the job ends with an error that any store can take.
      job.is_committing = false;
      if (std::exchange(was_replaced, true)) throw;
      outcome = unstorable(job, HttpError(500, "internal", "the outcome of this job cannot be stored"), error.what());
    }
  }
}

}  // namespace remesh::server::jobs
