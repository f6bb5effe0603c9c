#include "server/jobs/lease_judge.h"

#include <algorithm>
#include <utility>

namespace remesh::server::jobs {
namespace {

/// An answer that takes longer than this may have waited for a lock or a frozen server, which then also stopped the
/// other workers. The time of such a call does not count.
constexpr std::chrono::seconds kPrompt{1};

}  // namespace

void LeaseJudge::record_reached(Clock::time_point asked, Clock::time_point answered) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(is_reached_, true)) {
    const Clock::time_point until = answered - asked <= kPrompt ? answered : asked;
    counted_ += std::clamp<Clock::duration>(until - last_answer_, Clock::duration(0), max_pause_);
  }
  last_answer_ = std::max(last_answer_, answered);
}

void LeaseJudge::record_failed() {
  const std::lock_guard lock(mutex_);
  is_reached_ = false;
}

void LeaseJudge::see(const Sign& sign) {
  const std::lock_guard lock(mutex_);
  record_locked(sign);
}

std::vector<LeaseJudge::Sign> LeaseJudge::judge(const std::vector<Sign>& running) {
  const std::lock_guard lock(mutex_);
  std::map<std::string, Seen, std::less<>> before;
  before.swap(seen_);
  std::vector<Sign> over;
  for (const Sign& sign : running) {
    if (auto known = before.extract(sign.id)) seen_.insert(std::move(known));
    if (record_locked(sign)) over.push_back(sign);
  }
  return over;
}

bool LeaseJudge::record_locked(const Sign& sign) {
  const Seen now{sign.token, sign.version, sign.lease, counted_};
  const auto [found, is_new] = seen_.try_emplace(sign.id, now);
  Seen& seen = found->second;
  if (is_new) return false;
  if (seen.token != sign.token || seen.version != sign.version) {
    seen = now;
    return false;
  }
  return counted_ - seen.at >= sign.lease;
}

}  // namespace remesh::server::jobs
