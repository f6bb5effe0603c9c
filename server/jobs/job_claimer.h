/// Claims jobs from the store, in a thread of its own, whenever this process has room for another one.
#pragma once

#include <functional>
#include <thread>

#include "server/jobs/lease_keeper.h"

namespace remesh::server::jobs {

class JobClaimer {
 public:
  /// Begins the work on a job that was claimed. The share is memory that was reserved for it, or null.
  using Begin = std::function<void(Claim, std::shared_ptr<MemoryShare>)>;

  /// Input: `worker` - the name of this process in the store.
  JobClaimer(JobStore& store, MemoryBudget& memory, const LeaseKeeper& leases, std::string worker,
             std::function<bool()> has_room, Begin begin);

  void start() {
    thread_ = std::thread([this] { claim_until_drained(); });
  }
  /// Tells the claimer that there may be a job to claim, or room for one.
  void wake() { wake_.set(); }
  /// Claims no more jobs from now on.
  void begin_drain();
  /// Waits for the end of the last claim after `begin_drain`.
  void join();
  /// Claims no job until that time.
  void pause_until(Clock::time_point time) { next_claims_ = time; }
  /// True while a claim has not reached `begin` yet.
  bool is_claiming() const { return claiming_ > 0; }

 private:
  enum class Step { kClaimed, kNothing, kNoRoom };
  /// The job that is next in turn but for which there is no memory, and its place in the line.
  struct PassedOver {
    WaitingJob job;
    Clock::time_point since;
    std::shared_ptr<MemoryShare> share;
    std::optional<Clock::time_point> alone_since;  ///< since when only requests keep memory from it; no job may pass
    Clock::time_point others_until;                ///< until this time, other jobs may pass
  };
  /// The last claim that found no job for the available memory, and the time when it may be repeated with the same
  /// memory.
  struct EmptyClaim {
    std::uint64_t room;
    Clock::time_point again;
  };

  void claim_until_drained();
  Step claim_one();
  /// Checks whether the job that is next in turn waits for memory, and gives it a place in the line for memory.
  void look_for_passed_over();
  /// Output: the memory for the next claim; nothing if no job may be claimed now.
  std::optional<std::uint64_t> memory_for_claim();
  /// True if no other job may pass the one that is passed over any more.
  bool holds_up_jobs();

  JobStore& store_;
  MemoryBudget& memory_;
  const LeaseKeeper& leases_;
  const std::string worker_;
  const std::function<bool()> has_room_;
  const Begin begin_;
  Event wake_;
  std::atomic<bool> draining_{false};
  std::atomic<std::size_t> claiming_{0};
  std::atomic<Clock::time_point> next_claims_{Clock::time_point::min()};  ///< no job is claimed before this time
  // The following members are used by the claiming thread alone.
  std::optional<PassedOver> passed_over_;
  Clock::time_point next_look_{};
  std::optional<EmptyClaim> empty_claim_;
  std::thread thread_;
};

}  // namespace remesh::server::jobs
