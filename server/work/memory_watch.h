/// Watches the memory that the process really takes, because no estimate from a body's size is certain. Free memory of
/// the allocator does not count, and is returned to the system before the process takes more than the budget. If that
/// is not enough, the request with the largest growth is ended.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

#include "server/work/memory_budget.h"
#include "server/work/periodic.h"
#include "server/work/request_registry.h"

namespace remesh::server {

class MemoryWatch {
 public:
  static constexpr std::chrono::milliseconds kPeriod{20};

  MemoryWatch(MemoryBudget& budget, RequestRegistry& registry, std::chrono::milliseconds period = kPeriod);

  /// Performs one check. It is public for tests.
  /// Input: `used` - the memory in use now. `soon` - the memory that would be in use by the time when a request that is
  ///        ended now has stopped.
  void look(std::uint64_t used, std::uint64_t soon);
  void look(std::uint64_t used) { look(used, used); }
  /// Records a measurement.
  /// Output: the expected growth, beyond the recent maximum, until work that is cancelled now has stopped, if memory
  ///         continues to grow as it did recently. It is 0 unless nearly all of the budget is in use.
  std::uint64_t expected_growth(std::uint64_t used, Clock::time_point now);

 private:
  void measure_and_look();
  /// Output: the memory of the process without the free memory of the allocator.
  std::uint64_t used_of(std::uint64_t resident);

  MemoryBudget& budget_;
  RequestRegistry& registry_;
  struct Look {
    Clock::time_point time;
    std::uint64_t used;
  };
  std::deque<Look> lately_;  ///< oldest first
  std::uint64_t last_used_ = 0;
  std::uint64_t free_ = 0;  ///< free memory of the allocator at the last measurement
  Clock::time_point next_measurement_{};
  std::uint64_t resident_after_trim_ = 0;
  Clock::time_point next_trim_{};
  Clock::time_point next_small_trim_{};  ///< see kBetweenSmallTrims
  Clock::time_point asked_{};            ///< when the threads were asked to return free memory
  Clock::time_point patience_until_{};
  Periodic looks_;
};

}  // namespace remesh::server
