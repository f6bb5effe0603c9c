#include "server/jobs/job_runner.h"

#include <algorithm>
#include <utility>

#include "server/http/error_response.h"
#include "server/jobs/job_request.h"
#include "server/observe/log.h"
#include "server/work/work.h"

namespace remesh::server::jobs {
namespace {

/// After this many pauses because this daemon lacks the folder of a job's input, the job fails.
constexpr int kMaxPauses = 5;
/// The max number of jobs for which pauses are counted. Beyond it, all counts are deleted, because most of these jobs
/// were done elsewhere.
constexpr std::size_t kMaxPaused = 1000;
/// The max time that cancelled work may take to stop.
constexpr std::chrono::milliseconds kStopPatience{1100};
/// The error of a job that found no memory or threads in its last attempt. The status 500, unlike 503, means that
/// trying again is useless.
HttpError given_up(const std::string& code, int attempts) {
  return HttpError(500, code,
                   "the job failed because there was not enough memory or no thread; attempt " +
                       std::to_string(attempts) + " was the last");
}

}  // namespace

JobRunner::JobRunner(JobStore& store, WorkerPool& pool, RequestRegistry& registry, MemoryBudget& memory,
                     Metrics& metrics, KeepOperation operation, RunnerSettings settings)
    : store_(store),
      pool_(pool),
      registry_(registry),
      memory_(memory),
      metrics_(metrics),
      operation_(std::move(operation)),
      settings_(std::move(settings)),
      leases_(store, metrics, settings_),
      committer_(store, metrics, [this](const auto& job) { release(job); }),
      claimer_(
          store, memory, leases_, settings_.worker, [this] { return has_room(); },
          [this](Claim claim, std::shared_ptr<MemoryShare> share) { begin(std::move(claim), std::move(share)); }) {}

JobRunner::~JobRunner() { stop(); }

void JobRunner::start() {
  leases_.start();
  committer_.start();
  claimer_.start();
}

void JobRunner::stop() {
  if (std::exchange(is_stopped_, true)) return;
  const Clock::time_point deadline = Clock::now() + kStopPatience;
  claimer_.begin_drain();
  committer_.begin_stop();
  claimer_.join();
  for (const std::shared_ptr<ActiveJob>& job : leases_.jobs()) {
    job->running->cancel();
    if (!pool_.withdraw(*job->ticket)) continue;
    leases_.give_back(*job, JobStore::Attempt::kDoesNotCount, "shutdown");
    release(job);
  }
  while (!is_idle() && Clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  leases_.return_late();
  committer_.join();
  leases_.stop();
}

void JobRunner::drop(const std::string& id) {
  for (const std::shared_ptr<ActiveJob>& job : leases_.jobs()) {
    if (job->claim.id == id) job->lose();
  }
}

bool JobRunner::has_room() const {
  const LeaseKeeper::Jobs jobs = leases_.jobs();
  const auto computing = std::count_if(jobs.begin(), jobs.end(), [](const auto& job) { return !job->is_computed; });
  // No new work begins while finished results wait for the store.
  return static_cast<std::size_t>(computing) < settings_.max_held && committer_.waiting() < settings_.max_held &&
         !pool_.is_full(WorkerPool::kSmallBytes + 1);
}

void JobRunner::begin(Claim claim, std::shared_ptr<MemoryShare> share) {
  const auto job = std::make_shared<ActiveJob>(std::move(claim), registry_);
  log::write(log::Level::kInfo, "job claimed",
             {{"job", job->claim.id}, {"token", job->claim.token}, {"attempt", std::int64_t{job->claim.attempts}}});
  try {
    if (share) {
      share->hold_answer(job->claim.memory);
      job->memory = std::move(share);
    } else {
      job->memory = memory_.open_share(/*per_byte=*/1);
      job->memory->hold_body(job->claim.memory, job->claim.memory);
    }
    leases_.add(job);
    job->ticket = pool_.try_submit([this, job] { run(job); }, job->claim.memory / MemoryBudget::kWorkPerBodyByte);
    if (job->ticket) return;
    leases_.remove(job);
  } catch (const HttpError&) {
    // Another request reserved the memory first.
  }
  leases_.give_back(*job, JobStore::Attempt::kDoesNotCount, "no_room");
}

void JobRunner::run(const std::shared_ptr<ActiveJob>& job) {
  try {
    if (std::optional<JobOutcome> outcome = work_on(*job)) {
      job->ended = Clock::now();
      job->outcome = std::move(*outcome);
      committer_.add(job);
      claimer_.wake();
      return;
    }
  } catch (const std::exception& error) {
    // The lease will expire, and another worker will try the job again.
    log::write(log::Level::kError, "job left", {{"job", job->claim.id}, {"error", std::string(error.what())}});
  }
  release(job);
}

void JobRunner::release(const std::shared_ptr<ActiveJob>& job) {
  leases_.remove(job);
  job->memory.reset();
  claimer_.wake();
}

std::optional<JobOutcome> JobRunner::work_on(ActiveJob& job) {
  RunningRequest& running = *job.running.get();
  job.started = Clock::now();
  try {
    const std::optional<std::string> input = store_.read_blob(job.claim.id, BlobKind::kInput);
    running.control.check();
    if (!input) throw std::runtime_error("the input of a job is missing");
    api::Request request = unpack_request(job.claim.request);
    request.body = *input;
    running.is_computing = true;
    api::StoredRemesh stored = operation_(request, with_trace(settings_.limits, job.claim.id), running.control);
    running.is_computing = false;
    metrics_.count_work(stored.done);
    job.done = std::move(stored.done);
    job.memory->hold_answer(stored.mesh.size() + stored.report.size());
    return JobOutcome{JobState::kSucceeded, std::move(stored.mesh), std::move(stored.report), 0, ""};
  } catch (const StoreError&) {
    leases_.give_back(job, JobStore::Attempt::kDoesNotCount, "store");
    return std::nullopt;
  } catch (const NoFolder&) {
    if (!pause_without_folder(job.claim)) return outcome_of_failure(job, std::current_exception());
    leases_.give_back(job, JobStore::Attempt::kDoesNotCount, "no_folder");
    return std::nullopt;
  } catch (...) {
    running.is_computing = false;
    return outcome_of_failure(job, std::current_exception());
  }
}

bool JobRunner::pause_without_folder(const Claim& claim) {
  const std::lock_guard lock(mutex_);
  if (pauses_.size() > kMaxPaused) pauses_.clear();
  if (++pauses_[claim.id] > kMaxPauses) {
    pauses_.erase(claim.id);
    return false;
  }
  claimer_.pause_until(Clock::now() + settings_.rules.lease);
  log::write(log::Level::kError,
             "a job's input is in a folder, but --blob-dir is not set; for a while this "
             "daemon claims no jobs",
             {{"job", claim.id}, {"pause_s", std::chrono::duration<double>(settings_.rules.lease).count()}});
  return true;
}

std::optional<JobOutcome> JobRunner::outcome_of_failure(ActiveJob& job, std::exception_ptr failure) {
  using Eviction = RunningRequest::Eviction;
  if (job.is_lost) return std::nullopt;
  const bool may_retry = job.claim.attempts < settings_.rules.max_attempts;
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    const Eviction eviction = job.running->eviction;
    if (error.code == Code::kCancelled && eviction == Eviction::kNone) {
      leases_.give_back(job, JobStore::Attempt::kDoesNotCount, "shutdown");
      return std::nullopt;
    }
    if (error.code == Code::kCancelled && eviction == Eviction::kAmongOthers) {
      // Other work used memory, too. With the memory that the job was seen to take reserved for it alone, if necessary
      // all memory, it may succeed.
      const std::uint64_t estimate =
          memory_.next_reservation(job.running->next_estimate(job.claim.memory), job.claim.memory);
      // A job that had all memory reserved cannot get more, so it is not tried again.
      const bool had_all = job.claim.memory >= memory_.limit();
      if (!had_all || may_retry) {
        const auto attempt = had_all ? JobStore::Attempt::kCounts : JobStore::Attempt::kDoesNotCount;
        leases_.give_back(job, attempt, "out_of_memory", estimate);
        return std::nullopt;
      }
      failure = std::make_exception_ptr(out_of_memory());
    }
    if (error.code == Code::kCancelled && eviction == Eviction::kAlone)
      failure = std::make_exception_ptr(never_fits(memory_.limit()));
  } catch (...) {
    // The cause may be a lack of memory or threads, which may be gone at the next attempt, or a defect, which would
    // repeat.
  }
  Response problem = error_response(failure, job.claim.id);
  if (problem.status == 503) {
    if (may_retry)
      return leases_.give_back(job, JobStore::Attempt::kCounts, problem.problem_code.c_str()), std::nullopt;
    problem = error_response(std::make_exception_ptr(given_up(problem.problem_code, job.claim.attempts)), job.claim.id);
  }
  return JobOutcome{
      JobState::kFailed, "", "", problem.status, std::move(problem.body), std::move(problem.problem_code)};
}

}  // namespace remesh::server::jobs
