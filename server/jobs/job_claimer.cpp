#include "server/jobs/job_claimer.h"

#include <exception>
#include <utility>

#include "server/http/exchange.h"
#include "server/observe/log.h"

namespace remesh::server::jobs {
namespace {

/// The max time between two attempts to claim. It matters if a notification from the store was missed.
constexpr std::chrono::seconds kPoll{5};
/// The pause between attempts while the store does not answer or there is no room.
constexpr std::chrono::milliseconds kPause{250};
/// The pause between two searches for a job that is passed over because there is no memory for it.
constexpr std::chrono::milliseconds kBetweenLooks{1000};
/// The pause between two claims while a job is passed over, no more memory is free, and no new jobs have been
/// announced. These claims find jobs that were submitted to other daemons.
constexpr std::chrono::milliseconds kBetweenClaims{1000};
/// The max time for which a job that is passed over holds up other jobs while only requests are in its way. Then other
/// jobs pass for a while.
constexpr std::chrono::seconds kMaxHeldUp = MemoryBudget::kLongestTurn;
constexpr std::chrono::seconds kOthersPass = MemoryBudget::kPause;

}  // namespace

JobClaimer::JobClaimer(JobStore& store, MemoryBudget& memory, const LeaseKeeper& leases, std::string worker,
                       std::function<bool()> has_room, Begin begin)
    : store_(store),
      memory_(memory),
      leases_(leases),
      worker_(std::move(worker)),
      has_room_(std::move(has_room)),
      begin_(std::move(begin)) {}

void JobClaimer::begin_drain() {
  draining_ = true;
  wake_.set();
}

void JobClaimer::join() {
  if (thread_.joinable()) thread_.join();
}

void JobClaimer::claim_until_drained() {
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
      passed_over_.reset();               // no memory is set aside while no job can be claimed
      wake_.wait(Clock::now() + kPause);  // the store's observer has logged the error
    } catch (const std::exception& error) {
      passed_over_.reset();
      log::write(log::Level::kError, "cannot claim jobs", {{"error", std::string(error.what())}});
      wake_.wait(Clock::now() + kPoll);
    }
    wake_.clear();
  }
  passed_over_.reset();
}

JobClaimer::Step JobClaimer::claim_one() {
  if (Clock::now() < next_claims_.load() || !has_room_()) {
    if (passed_over_) passed_over_->share->leave_line();  // the job could not begin, so others need not wait
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
  std::optional<Claim> claim = store_.claim(worker_, *room);
  empty_claim_.reset();
  if (!claim) empty_claim_ = EmptyClaim{*room, Clock::now() + kBetweenClaims};
  // Another worker may have taken the job meanwhile. If another job came before it in turn, it keeps its place in the
  // line.
  if (passed_over_ && (claim ? claim->id == passed_over_->job.id : share != nullptr)) passed_over_.reset();
  if (!claim) {
    next_look_ = {};
    look_for_passed_over();
    return passed_over_ ? Step::kNoRoom : Step::kNothing;
  }
  begin_(std::move(*claim), std::move(share));
  return Step::kClaimed;
}

void JobClaimer::look_for_passed_over() {
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
  // If a job that has come before the other one in turn fits, it is claimed, and the other one keeps its place.
  if (next->memory <= memory_.available()) return;
  const Clock::time_point since = passed_over_ ? passed_over_->since : now;
  passed_over_ = PassedOver{std::move(*next), since, memory_.open_share(/*per_byte=*/1), std::nullopt, {}};
}

std::optional<std::uint64_t> JobClaimer::memory_for_claim() {
  if (passed_over_) {
    passed_over_->share->stand_in_line(passed_over_->since);
    if (passed_over_->share->try_hold(passed_over_->job.memory)) return passed_over_->job.memory;
    if (holds_up_jobs()) return std::nullopt;
  }
  const std::uint64_t available = memory_.available();
  return available > 0 ? std::optional(available) : std::nullopt;
}

bool JobClaimer::holds_up_jobs() {
  const Clock::time_point now = Clock::now();
  PassedOver& first = *passed_over_;
  if (now < first.since + memory_.patience() || now < first.others_until) return false;
  if (!leases_.jobs().empty()) {
    // No job may follow the running jobs, so their memory becomes free for the first job in line.
    first.alone_since.reset();
    return true;
  }
  if (!first.alone_since) first.alone_since = now;
  if (now < *first.alone_since + kMaxHeldUp) return true;
  first.alone_since.reset();
  first.others_until = now + kOthersPass;
  return false;
}

}  // namespace remesh::server::jobs
