#include "server/work/memory_budget.h"

namespace remesh::server {

// ---- the budget

std::uint64_t MemoryBudget::reserved() const {
  const std::lock_guard lock(mutex_);
  return reserved_;
}

std::size_t MemoryBudget::holders() const {
  const std::lock_guard lock(mutex_);
  return holders_;
}

std::size_t MemoryBudget::waiting() const {
  const std::lock_guard lock(mutex_);
  return line_.size();
}

std::uint64_t MemoryBudget::used_by_others_locked(std::uint64_t own) const {
  if (reserved_ <= own) return 0;
  return std::max<std::uint64_t>(reserved_, used_) - own;
}

std::uint64_t MemoryBudget::available(Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t used = used_by_others_locked(0);
  const std::uint64_t free = limit_ - std::min(limit_, used);
  if (!is_held_up_locked(nullptr, free, now)) return free;
  const MemoryShare& first = *line_.front();
  const std::uint64_t has = limit_ + first.bytes_;
  return has - std::min(has, used + first.needed_);
}

/// True if a newcomer must wait because the first share in line goes before it.
/// Input: `newcomer` - null for one that has no share yet; `needed` - the bytes that it asks for.
bool MemoryBudget::is_held_up_locked(const MemoryShare* newcomer, std::uint64_t needed, Clock::time_point now) {
  if (line_.empty()) return false;
  const MemoryShare* const first = line_.front();
  if (now < *first->waits_since_ + patience_) return false;
  if (!turn_ || turn_->first != first) begin_turn_locked(kFirstTurn, now);
  if (first == newcomer || now < turn_->pause_end) return false;
  // A newcomer that leaves enough room for the first in line takes nothing from it.
  if (used_by_others_locked(0) + needed + first->needed_ <= limit_ + first->bytes_) return false;

  // As long as there are old holders, memory that is really in use counts as theirs.
  const std::uint64_t young_bytes = reserved_ - turn_->old_bytes;
  const std::uint64_t old_used = std::max(turn_->old_bytes, used_ - std::min<std::uint64_t>(used_, young_bytes));
  const bool is_hopeless = turn_->old_bytes > 0 && old_used + first->needed_ > limit_ + first->bytes_;
  if (is_hopeless) {
    turn_->held_up_since.reset();
    return false;
  }
  if (!turn_->held_up_since) turn_->held_up_since = now;
  if (now < *turn_->held_up_since + turn_->length) return true;
  begin_turn_locked(std::min<std::chrono::seconds>(2 * turn_->length, kLongestTurn), now + kPause);
  return false;
}

void MemoryBudget::begin_turn_locked(std::chrono::seconds length, Clock::time_point pause_end) {
  turn_ = Turn{line_.front(), next_number_, reserved_, length, pause_end, std::nullopt};
}

void MemoryBudget::resize_locked(MemoryShare& share, std::uint64_t bytes) {
  if (share.bytes_ == 0 && bytes > 0) {
    ++holders_;
    share.number_ = next_number_++;
  }
  if (share.bytes_ > 0 && bytes == 0) --holders_;
  reserved_ = reserved_ - share.bytes_ + bytes;
  if (turn_ && share.number_ < turn_->newcomers) turn_->old_bytes = turn_->old_bytes - share.bytes_ + bytes;
  share.bytes_ = bytes;
}

void MemoryBudget::leave_line_locked(MemoryShare& share) {
  if (!share.waits_since_) return;
  share.waits_since_.reset();
  line_.remove(&share);
  if (turn_ && turn_->first == &share) turn_.reset();
}

// ---- the share of one request

MemoryShare::~MemoryShare() {
  const std::lock_guard lock(budget_.mutex_);
  budget_.leave_line_locked(*this);
  budget_.resize_locked(*this, 0);
}

bool MemoryShare::try_hold_body(std::uint64_t held, std::uint64_t expected, Clock::time_point now) {
  const std::uint64_t limit = budget_.limit_;
  const std::uint64_t body = std::max(held, expected);
  if (body > limit) throw never_fits(limit);
  const std::uint64_t max_with_work = std::max(body, budget_.usual_limit());
  const auto with_work = [&](std::uint64_t bytes) {
    return bytes > max_with_work / per_byte_ ? max_with_work : bytes * per_byte_;
  };
  return try_reserve(std::max(bytes_, with_work(held)), std::max(bytes_, with_work(body)), now);
}

std::uint64_t MemoryShare::next_reservation(std::uint64_t wanted) const {
  return budget_.next_reservation(wanted, bytes_);
}

bool MemoryShare::try_hold(std::uint64_t bytes, Clock::time_point now) {
  const std::uint64_t wanted = std::min(bytes, budget_.limit_);
  return try_reserve(wanted, wanted, now);
}

bool MemoryShare::try_reserve(std::uint64_t wanted, std::uint64_t needed, Clock::time_point now) {
  const std::lock_guard lock(budget_.mutex_);
  needed_ = needed;
  const bool is_newcomer = bytes_ == 0 && needed > 0;
  if (is_newcomer && budget_.is_held_up_locked(this, needed, now)) return false;
  if (needed > bytes_ && budget_.used_by_others_locked(bytes_) + needed > budget_.limit_) return false;
  budget_.resize_locked(*this, wanted);
  budget_.leave_line_locked(*this);
  return true;
}

void MemoryShare::hold_answer(std::uint64_t bytes) {
  const std::lock_guard lock(budget_.mutex_);
  budget_.resize_locked(*this, bytes);
}

void MemoryShare::stand_in_line(Clock::time_point since) {
  const std::lock_guard lock(budget_.mutex_);
  stand_in_line_locked(since);
}

bool MemoryShare::try_stand_in_line(Clock::time_point now) {
  const std::lock_guard lock(budget_.mutex_);
  if (budget_.line_.size() >= budget_.max_waiting_) return false;
  stand_in_line_locked(now);
  return true;
}

void MemoryShare::stand_in_line_locked(Clock::time_point since) {
  if (waits_since_) return;
  waits_since_ = since;
  std::list<MemoryShare*>& line = budget_.line_;
  const auto last =
      std::find_if(line.rbegin(), line.rend(), [&](const MemoryShare* other) { return *other->waits_since_ <= since; });
  line.insert(last.base(), this);
}

void MemoryShare::leave_line() {
  const std::lock_guard lock(budget_.mutex_);
  budget_.leave_line_locked(*this);
}

bool MemoryShare::is_stuck() const {
  const std::lock_guard lock(budget_.mutex_);
  const auto holds = [](const MemoryShare* share) { return share->bytes_ > 0; };
  const auto growing = std::count_if(budget_.line_.begin(), budget_.line_.end(), holds);
  if (growing == 0 || static_cast<std::size_t>(growing) < budget_.holders_) return false;
  return *std::find_if(budget_.line_.rbegin(), budget_.line_.rend(), holds) == this;
}

}  // namespace remesh::server
