/// How long calls wait for a store that does not answer.
///
/// Every call of the store has a deadline. The calls of one request share a deadline, so that a request with several
/// calls waits no longer than a request with one. While the daemon stops, all calls end early.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>

#include "server/http/connection.h"

namespace remesh::server::jobs {

/// The time at which all calls end because the daemon stops. It may be set from any thread.
class StoreEnd {
 public:
  void set(Clock::time_point time) { time_ = time; }
  Clock::time_point get() const { return time_; }

 private:
  std::atomic<Clock::time_point> time_{Clock::time_point::max()};
};

/// The deadline of one call. If the daemon stops, the deadline becomes earlier, even while the call waits.
class StoreDeadline {
 public:
  StoreDeadline(Clock::time_point time, const StoreEnd& end) : time_(time), end_(&end) {}

  Clock::time_point time() const { return std::min(time_, end_->get()); }
  bool is_over() const { return Clock::now() >= time(); }
  /// The time that is left, in whole milliseconds, but at most `limit`.
  std::chrono::milliseconds left(std::chrono::milliseconds limit) const {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(time() - Clock::now());
    return std::clamp(left, std::chrono::milliseconds(0), limit);
  }
  /// The same deadline, but not later than the given time.
  StoreDeadline sooner(Clock::time_point time) const { return StoreDeadline(std::min(time_, time), *end_); }
  /// Gives the call that much time from now on, if it has less. A call that transfers many bytes extends its deadline
  /// after each piece: only time without an answer counts.
  void extend(std::chrono::milliseconds more) { time_ = std::max(time_, Clock::now() + more); }

 private:
  Clock::time_point time_;
  const StoreEnd* end_;
};

/// A scope in which all calls of this thread share one deadline.
class SharedStoreDeadline {
 public:
  explicit SharedStoreDeadline(Clock::time_point time);
  ~SharedStoreDeadline();
  SharedStoreDeadline(const SharedStoreDeadline&) = delete;
  SharedStoreDeadline& operator=(const SharedStoreDeadline&) = delete;

  /// The deadline of the innermost scope of this thread.
  /// Output: `otherwise`, if there is no scope.
  static Clock::time_point current(Clock::time_point otherwise);

 private:
  Clock::time_point before_;
};

}  // namespace remesh::server::jobs
