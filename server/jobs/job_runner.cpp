#include "server/jobs/job_runner.h"

#include <algorithm>
#include <exception>
#include <utility>
#include <vector>

#include "server/http/error_response.h"
#include "server/http/exchange.h"
#include "server/jobs/job_request.h"
#include "server/jobs/store_deadline.h"
#include "server/observe/log.h"
#include "server/work/work.h"

namespace remesh::server::jobs {
namespace {

/// The longest time between two attempts to claim. It covers notifications from the store that were missed.
constexpr std::chrono::seconds kPoll{5};
/// The pause between attempts while the store does not answer or there is no room.
constexpr std::chrono::milliseconds kPause{250};
constexpr std::chrono::milliseconds kMaxBetweenLooks{1000};
/// The pause between two looks for a job that is passed over because it finds no memory.
constexpr std::chrono::milliseconds kBetweenLooks{1000};
/// The pause between two claims while a job is passed over, no more memory is free, and nobody says that there are new
/// jobs. It finds jobs that were submitted to other daemons.
constexpr std::chrono::milliseconds kBetweenClaims{1000};
/// A job that is passed over holds up other jobs for no longer than this while only requests are in its way. Then other
/// jobs pass for a while.
constexpr std::chrono::seconds kMaxHeldUp = MemoryBudget::kLongestTurn;
constexpr std::chrono::seconds kOthersPass = MemoryBudget::kPause;
/// A job fails that finds this daemon without its folder after so many pauses for it.
constexpr int kMaxPauses = 5;
/// If pauses are remembered for more jobs than this, they are forgotten. Most of these jobs were done elsewhere.
constexpr std::size_t kMaxPaused = 1000;
/// How long cancelled work may take to stop.
constexpr std::chrono::milliseconds kStopPatience{1100};
/// How long a result waits for room in the store before its job fails. Until then other work waits for the memory that
/// it takes.
constexpr std::chrono::minutes kRoomPatience{15};

/// The error of a job that found no memory or threads in its last attempt. The status 500 says that trying again is
/// of no use, unlike a 503.
HttpError given_up(const std::string& code, int attempts) {
  return HttpError(
      500, code,
      "the job ended because memory or threads were lacking; attempt " + std::to_string(attempts) + " was the last");
}

}  // namespace

/// A job that this process works on.
struct JobRunner::Held {
  Held(Claim its_claim, RequestRegistry& registry)
      : claim(std::move(its_claim)), running(registry.add(new_request_id())), renewed(Clock::now()) {}

  const Claim claim;
  const RequestRegistry::Entry running;
  std::shared_ptr<MemoryShare> memory;
  std::optional<WorkerPool::Ticket> ticket;  ///< its place in the pool's queue; guarded by the runner's mutex
  bool is_done = false;                      ///< computed, and waiting for its commit; guarded by the runner's mutex
  std::atomic<bool> is_lost{false};
  std::atomic<bool> is_committing{false};
  std::atomic<Clock::time_point> started{Clock::time_point::max()};
  // These members are for the thread that commits.
  Clock::time_point ended{};  ///< the time at which computing ended
  std::optional<api::WorkDone> done;
  // These members are used by the renewing thread alone.
  Clock::time_point renewed;
  Progress told;
};

JobRunner::JobRunner(JobStore& store, WorkerPool& pool, RequestRegistry& registry, MemoryBudget& memory,
                     Metrics& metrics, KeepOperation operation, RunnerSettings settings)
    : store_(store),
      pool_(pool),
      registry_(registry),
      memory_(memory),
      metrics_(metrics),
      operation_(std::move(operation)),
      settings_(std::move(settings)) {}

JobRunner::~JobRunner() { stop(); }

void JobRunner::start() {
  renewals_.emplace(std::min(kMaxBetweenLooks, settings_.lease / 8), [this] { renew_all(); });
  claimer_ = std::thread([this] { claim_until_stopped(); });
  committer_ = std::thread([this] { commit_until_stopped(); });
}

void JobRunner::begin_drain() {
  draining_ = true;
  wake_.set();
}

bool JobRunner::is_idle() const {
  const std::lock_guard lock(mutex_);
  return held_.empty() && claiming_ == 0;
}

std::list<std::shared_ptr<JobRunner::Held>> JobRunner::held() const {
  const std::lock_guard lock(mutex_);
  return held_;
}

void JobRunner::stop() {
  const Clock::time_point deadline = Clock::now() + kStopPatience;
  begin_drain();
  stopping_ = true;
  if (claimer_.joinable()) claimer_.join();
  for (const std::shared_ptr<Held>& held : held()) {
    std::optional<WorkerPool::Ticket> ticket;
    {
      const std::lock_guard lock(mutex_);
      ticket = held->ticket;
    }
    held->running->cancel();
    if (!ticket || !pool_.withdraw(*ticket)) continue;
    give_back(*held, JobStore::Attempt::kDoesNotCount, "shutdown");
    release(held);
  }
  while (!is_idle() && Clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return_late();
  {
    const std::lock_guard lock(mutex_);
    committer_may_end_ = true;
  }
  done_changed_.notify_all();
  if (committer_.joinable()) committer_.join();
  renewals_.reset();
}

void JobRunner::drop(const std::string& id) {
  for (const std::shared_ptr<Held>& held : held()) {
    if (held->claim.id != id) continue;
    held->is_lost = true;
    held->running->cancel();
  }
}

// ---- claiming

void JobRunner::claim_until_stopped() {
  while (!draining_) {
    try {
      const Step step = claim_one();
      if (step == Step::kClaimed) continue;
      if (step == Step::kNothing) {
        store_.wait_for_work(wake_, Clock::now() + kPoll);
      } else if (wake_.wait(Clock::now() + kPause)) {
        empty_claim_.reset();
      }
    } catch (const StoreError&) {
      passed_over_.reset();               // no memory is set aside while nothing can be claimed
      wake_.wait(Clock::now() + kPause);  // the store's observer has logged it
    } catch (const std::exception& error) {
      passed_over_.reset();
      log::write(log::Level::kError, "cannot claim jobs", {{"error", std::string(error.what())}});
      wake_.wait(Clock::now() + kPoll);
    }
    wake_.clear();
  }
  passed_over_.reset();
}

bool JobRunner::has_room() const {
  const std::lock_guard lock(mutex_);
  const auto computing = std::count_if(held_.begin(), held_.end(), [](const auto& held) { return !held->is_done; });
  // No new work begins while finished results wait for the store.
  const bool has_place = static_cast<std::size_t>(computing) < settings_.max_held && done_.size() < settings_.max_held;
  return has_place && !pool_.is_full(WorkerPool::kSmallBytes + 1);
}

JobRunner::Step JobRunner::claim_one() {
  if (Clock::now() < next_claims_.load() || !has_room()) {
    if (passed_over_) passed_over_->share->leave_line();  // it could not begin, so it is in nobody's way
    return Step::kNoRoom;
  }
  const Counted claiming(claiming_);
  if (draining_) return Step::kNothing;
  look_for_passed_over();
  const std::optional<std::uint64_t> room = memory_for_claim();
  if (!room) return Step::kNoRoom;
  std::shared_ptr<MemoryShare> share;
  if (passed_over_ && passed_over_->share->bytes() > 0)
    share = std::exchange(passed_over_->share, memory_.open_share(/*per_byte=*/1));
  const bool is_repeated =
      passed_over_ && !share && empty_claim_ && *room <= empty_claim_->room && Clock::now() < empty_claim_->again;
  if (is_repeated) return Step::kNoRoom;
  std::optional<Claim> claim = store_.claim(settings_.worker, *room);
  empty_claim_.reset();
  if (!claim) empty_claim_ = EmptyClaim{*room, Clock::now() + kBetweenClaims};
  // Another worker may have taken the job meanwhile. If another job came before it in turn, it keeps its place.
  if (passed_over_ && (claim ? claim->id == passed_over_->job.id : share != nullptr)) passed_over_.reset();
  if (!claim) {
    next_look_ = {};
    look_for_passed_over();
    return passed_over_ ? Step::kNoRoom : Step::kNothing;
  }
  hold(std::move(*claim), std::move(share));
  return Step::kClaimed;
}

void JobRunner::look_for_passed_over() {
  const Clock::time_point now = Clock::now();
  if (now < next_look_) return;
  next_look_ = now + kBetweenLooks;
  if (passed_over_) {
    const std::optional<JobRecord> record = store_.find(passed_over_->job.id);
    if (!record || record->state != JobState::kQueued) passed_over_.reset();
  }
  std::optional<WaitingJob> next = store_.next_in_turn(memory_.limit());
  if (!next) return passed_over_.reset();
  if (passed_over_ && passed_over_->job.id == next->id) {
    passed_over_->job = std::move(*next);  // its estimate may have changed
    return;
  }
  // A job that has come before the other in turn and fits is claimed, and the other keeps its place.
  if (next->memory <= memory_.available()) return;
  const Clock::time_point since = passed_over_ ? passed_over_->since : now;
  passed_over_ = PassedOver{std::move(*next), since, memory_.open_share(/*per_byte=*/1), std::nullopt, {}};
}

std::optional<std::uint64_t> JobRunner::memory_for_claim() {
  if (passed_over_) {
    passed_over_->share->stand_in_line(passed_over_->since);
    if (passed_over_->share->try_hold(passed_over_->job.memory)) return passed_over_->job.memory;
    if (holds_up_jobs()) return std::nullopt;
  }
  const std::uint64_t available = memory_.available();
  return available > 0 ? std::optional(available) : std::nullopt;
}

bool JobRunner::holds_up_jobs() {
  const Clock::time_point now = Clock::now();
  PassedOver& first = *passed_over_;
  if (now < first.since + memory_.patience() || now < first.others_until) return false;
  if (!held().empty()) {
    // These jobs will end, and nothing follows them.
    first.alone_since.reset();
    return true;
  }
  if (!first.alone_since) first.alone_since = now;
  if (now < *first.alone_since + kMaxHeldUp) return true;
  first.alone_since.reset();
  first.others_until = now + kOthersPass;
  return false;
}

void JobRunner::hold(Claim claim, std::shared_ptr<MemoryShare> share) {
  const auto held = std::make_shared<Held>(std::move(claim), registry_);
  log::write(log::Level::kInfo, "job claimed",
             {{"job", held->claim.id}, {"token", held->claim.token}, {"attempt", std::int64_t{held->claim.attempts}}});
  try {
    if (share) {
      share->hold_answer(held->claim.memory);
      held->memory = std::move(share);
    } else {
      held->memory = memory_.open_share(/*per_byte=*/1);
      held->memory->hold_body(held->claim.memory, held->claim.memory);
    }
    const std::uint64_t bytes = held->claim.memory / MemoryBudget::kWorkPerBodyByte;
    const std::lock_guard lock(mutex_);
    held_.push_back(held);
    held->ticket = pool_.try_submit([this, held] { run(held); }, bytes);
    if (held->ticket) return;
    held_.pop_back();
  } catch (const HttpError&) {
    // Another request reserved the memory first.
  }
  give_back(*held, JobStore::Attempt::kDoesNotCount, "no_room");
}

// ---- the lease

void JobRunner::renew_all() {
  // Where one row is locked, the others still get their turn.
  const SharedStoreDeadline deadline(Clock::now() + settings_.store_timeout);
  return_late();
  for (const std::shared_ptr<Held>& held : held()) {
    if (held->started.load() <= Clock::now() - settings_.job_timeout) held->running->control.expire();
    try {
      renew(*held);
    } catch (const StoreError&) {
      // The store's observer has logged it. The lease does not age while the store is away.
    } catch (const DataError& error) {
      log::write(log::Level::kError, "cannot renew a lease",
                 {{"job", held->claim.id}, {"error", std::string(error.what())}});
    }
  }
}

void JobRunner::return_late() {
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

void JobRunner::renew(Held& held) {
  if (held.is_lost || held.is_committing) return;
  const RunControl& control = held.running->control;
  const Progress now{std::string(stage_name(control.stage())), control.fraction()};
  const bool is_due = Clock::now() - held.renewed >= settings_.lease / 4;
  const bool has_moved = now.stage != held.told.stage || now.fraction != held.told.fraction;
  const Clock::time_point asked = Clock::now();
  if (is_due || has_moved ? store_.renew(held.claim, now) : store_.holds(held.claim)) {
    if (is_due || has_moved) held.renewed = asked;
    held.told = now;
    return;
  }
  if (held.is_committing) return;  // this claim itself has ended the job
  log::write(log::Level::kInfo, "job lost", {{"job", held.claim.id}, {"token", held.claim.token}});
  held.is_lost = true;
  held.running->cancel();
}

// ---- working

void JobRunner::run(const std::shared_ptr<Held>& held) {
  {
    const std::lock_guard lock(mutex_);
    held->ticket.reset();
  }
  try {
    if (std::optional<JobOutcome> outcome = work_on(*held)) {
      held->ended = Clock::now();
      {
        const std::lock_guard lock(mutex_);
        held->is_done = true;
        done_.emplace_back(held, std::move(*outcome));
      }
      done_changed_.notify_one();
      wake_.set();
      return;
    }
  } catch (const std::exception& error) {
    // The lease will run out, and another worker will try the job again.
    log::write(log::Level::kError, "job left", {{"job", held->claim.id}, {"error", std::string(error.what())}});
  }
  release(held);
}

void JobRunner::release(const std::shared_ptr<Held>& held) {
  {
    const std::lock_guard lock(mutex_);
    held_.remove(held);
  }
  held->memory.reset();
  wake_.set();
}

std::optional<JobOutcome> JobRunner::work_on(Held& held) {
  std::optional<std::string> input;
  held.started = Clock::now();
  try {
    input = store_.read_blob(held.claim.id, BlobKind::kInput);
  } catch (const StoreError&) {
    give_back(held, JobStore::Attempt::kDoesNotCount, "store");
    return std::nullopt;
  } catch (const NoFolder&) {
    if (pause_without_folder(held.claim)) {
      give_back(held, JobStore::Attempt::kDoesNotCount, "no_folder");
      return std::nullopt;
    }
    return outcome_of_failure(held, std::current_exception());
  } catch (const BlobLost&) {
    return outcome_of_failure(held, std::current_exception());
  } catch (const DataError&) {
    return outcome_of_failure(held, std::current_exception());
  }
  RunningRequest& running = *held.running.get();
  try {
    running.control.check();
    if (!input) throw std::runtime_error("the input of a job is missing");
    api::Request request = unpack_request(held.claim.request);
    request.body = *input;
    running.is_computing = true;
    api::StoredRemesh kept = operation_(request, settings_.limits, running.control);
    running.is_computing = false;
    metrics_.count_work(kept.done);
    held.done = std::move(kept.done);
    held.memory->hold_answer(kept.mesh.size() + kept.report.size());
    return JobOutcome{JobState::kSucceeded, std::move(kept.mesh), std::move(kept.report), 0, ""};
  } catch (...) {
    running.is_computing = false;
    return outcome_of_failure(held, std::current_exception());
  }
}

bool JobRunner::pause_without_folder(const Claim& claim) {
  const std::lock_guard lock(mutex_);
  if (pauses_.size() > kMaxPaused) pauses_.clear();
  if (++pauses_[claim.id] > kMaxPauses) {
    pauses_.erase(claim.id);
    return false;
  }
  next_claims_ = Clock::now() + settings_.lease;
  log::write(log::Level::kError, "a job's input is in a folder, but --blob-dir is missing; no jobs are claimed now",
             {{"job", claim.id}, {"pause_s", std::chrono::duration<double>(settings_.lease).count()}});
  return true;
}

std::optional<JobOutcome> JobRunner::outcome_of_failure(Held& held, const std::exception_ptr& failure) {
  using Eviction = RunningRequest::Eviction;
  if (held.is_lost) return std::nullopt;
  std::exception_ptr told = failure;
  const bool may_retry = held.claim.attempts < settings_.max_attempts;
  try {
    std::rethrow_exception(failure);
  } catch (const Error& error) {
    const Eviction eviction = held.running->eviction;
    if (error.code == Code::kCancelled && eviction == Eviction::kNone) {
      give_back(held, JobStore::Attempt::kDoesNotCount, "shutdown");
      return std::nullopt;
    }
    if (error.code == Code::kCancelled && eviction == Eviction::kAmongOthers) {
      // Others had a part in it. With the memory that it was seen to take reserved, if need be all, it has its chance.
      const std::uint64_t estimate =
          memory_.next_reservation(held.running->next_estimate(held.claim.memory), held.claim.memory);
      // With all memory reserved it cannot be given more, so it is not tried for ever.
      const bool had_all = held.claim.memory >= memory_.limit();
      if (!had_all || may_retry) {
        const auto attempt = had_all ? JobStore::Attempt::kCounts : JobStore::Attempt::kDoesNotCount;
        give_back(held, attempt, "out_of_memory", estimate);
        return std::nullopt;
      }
      told = std::make_exception_ptr(out_of_memory());
    }
    if (error.code == Code::kCancelled && eviction == Eviction::kAlone)
      told = std::make_exception_ptr(never_fits(memory_.limit()));
  } catch (...) {
    // The cause may be a lack of memory or threads, which may be gone at the next attempt, or a defect, which would
    // repeat.
  }
  Response problem = error_response(told, held.claim.id);
  if (problem.status == 503) {
    if (may_retry) return give_back(held, JobStore::Attempt::kCounts, problem.problem_code.c_str()), std::nullopt;
    problem =
        error_response(std::make_exception_ptr(given_up(problem.problem_code, held.claim.attempts)), held.claim.id);
  }
  return JobOutcome{
      JobState::kFailed, "", "", problem.status, std::move(problem.body), std::move(problem.problem_code)};
}

void JobRunner::commit_until_stopped() {
  std::unique_lock lock(mutex_);
  for (;;) {
    done_changed_.wait(lock, [this] { return committer_may_end_ || !done_.empty(); });
    if (done_.empty()) return;
    const std::shared_ptr<Held> held = done_.front().first;
    JobOutcome outcome = std::move(done_.front().second);
    done_.pop_front();
    lock.unlock();
    bool is_settled = true;
    try {
      is_settled = commit(*held, outcome);
    } catch (const std::exception& error) {
      log::write(log::Level::kError, "job left", {{"job", held->claim.id}, {"error", std::string(error.what())}});
    }
    if (is_settled) {
      release(held);
      lock.lock();
      continue;
    }
    // The result is held in memory until the store is back or the process ends. Others have their turn meanwhile.
    std::this_thread::sleep_for(kPause);
    lock.lock();
    done_.emplace_back(held, std::move(outcome));
  }
}

bool JobRunner::commit(Held& held, JobOutcome& outcome) {
  for (bool was_replaced = false;;) {
    try {
      held.is_committing = true;
      const bool is_done = store_.commit(held.claim, outcome);
      log_end(held, outcome, is_done ? "job committed" : "job refused");
      if (is_done) metrics_.count_job(state_name(outcome.state), outcome.problem_code);
      return true;
    } catch (const StoreFull& error) {
      held.is_committing = false;
      const bool is_result = outcome.state == JobState::kSucceeded;
      if (!is_result || Clock::now() < held.ended + kRoomPatience) return stopping_ || held.is_lost;
      outcome = unstorable(held, HttpError(507, "storage_full", "the store had no room for the result of this job"),
                           error.what());
    } catch (const StoreError&) {
      held.is_committing = false;
      return stopping_ || held.is_lost;
    } catch (const DataError& error) {
      // Trying the same again would fail again, so the job ends with an error that any store can take.
      held.is_committing = false;
      if (std::exchange(was_replaced, true)) throw;
      outcome = unstorable(held, HttpError(500, "internal", "the outcome of this job cannot be stored"), error.what());
    }
  }
}

JobOutcome JobRunner::unstorable(const Held& held, const HttpError& told, std::string reason) {
  log::write(log::Level::kError, "the job store cannot take the outcome of a job",
             {{"job", held.claim.id}, {"error", std::move(reason)}});
  Response problem = error_response(std::make_exception_ptr(told), held.claim.id);
  return JobOutcome{
      JobState::kFailed, "", "", problem.status, std::move(problem.body), std::move(problem.problem_code)};
}

void JobRunner::log_end(const Held& held, const JobOutcome& outcome, std::string_view event) {
  std::vector<log::Field> fields{{"job", held.claim.id},
                                 {"token", held.claim.token},
                                 {"state", std::string(state_name(outcome.state))},
                                 {"work_ms", milliseconds_between(held.started.load(), held.ended)}};
  if (!outcome.problem_code.empty()) fields.push_back({"code", outcome.problem_code});
  if (held.done) add_work(*held.done, fields);
  log::write(log::Level::kInfo, event, fields);
}

void JobRunner::give_back(Held& held, JobStore::Attempt attempt, const char* reason,
                          std::optional<std::uint64_t> memory) {
  held.is_committing = true;
  const Return wanted{held.claim, attempt, reason, memory};
  try {
    try_to(wanted);
  } catch (const StoreError&) {
    const std::lock_guard lock(mutex_);
    late_returns_.push_back(wanted);
  }
}

void JobRunner::try_to(const Return& give_back) {
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
