/// Watches the memory that the process really takes, since no estimate from a body's size can be certain. When it
/// exceeds the budget, the request with the largest growth is ended.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/work/memory_budget.h"
#include "server/work/periodic.h"
#include "server/work/request_registry.h"

namespace remesh::server {

class MemoryWatch {
 public:
  static constexpr std::chrono::milliseconds kPeriod{20};

  MemoryWatch(MemoryBudget& budget, RequestRegistry& registry, std::chrono::milliseconds period = kPeriod);

  /// Performs one check with the given memory in use. It is public for tests.
  void look(std::uint64_t resident);

 private:
  void give_back(std::uint64_t resident);

  MemoryBudget& budget_;
  RequestRegistry& registry_;
  std::uint64_t last_resident_ = 0;
  std::uint64_t resident_after_trim_ = 0;
  Clock::time_point patience_until_{};
  Periodic looks_;
};

}  // namespace remesh::server
