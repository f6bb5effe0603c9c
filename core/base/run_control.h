/// Lets a caller watch and stop a running remesh.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>

#include "core/base/error.h"
#include "core/base/memory_bound.h"

namespace remesh {

/// State that the computing thread shares with the threads that watch it. All members may be called from any thread.
/// Work calls `check()`, or `check_and_move()`, so often (every few thousand elements) that a request to stop takes
/// effect within 100 ms.
class RunControl {
 public:
  using Clock = std::chrono::steady_clock;

  /// Asks the work to stop. It ends with Code::kCancelled. Only the first request to stop counts.
  void cancel() { request_stop(Reason::kCancelled); }
  /// Asks the work to stop because its time is over. It ends with Code::kTimeout.
  void expire() { request_stop(Reason::kTimeout); }
  bool is_stopped() const { return stop_.load(std::memory_order_relaxed) != Reason::kNone; }

  /// Errors: kCancelled or kTimeout - the work was asked to stop.
  void check() const {
    const Reason reason = stop_.load(std::memory_order_relaxed);
    if (reason != Reason::kNone) throw_stopped(reason);
    // The count continues through all runs of a thread. It makes no difference which check reports progress.
    thread_local std::uint32_t checks = 0;
    if (++checks % kChecksPerMove == 0) moves_.fetch_add(1, std::memory_order_relaxed);
  }
  /// Does the same as `check`, and always moves the progress. Work that does thousands of items between two checks
  /// calls this.
  void check_and_move() const {
    check();
    moves_.fetch_add(1, std::memory_order_relaxed);
  }

  /// Does the same as `check` for comparisons of a sort. There are so many of them that progress moves only once in
  /// thousands: later moves are smaller than earlier ones, and little would be left for the work after the sort.
  void check_comparison() const {
    const Reason reason = stop_.load(std::memory_order_relaxed);
    if (reason != Reason::kNone) throw_stopped(reason);
    thread_local std::uint32_t comparisons = 0;
    if (++comparisons % kComparisonsPerMove == 0) moves_.fetch_add(1, std::memory_order_relaxed);
  }

  /// Enters a stage. Progress starts again at 0. Checks for cancellation.
  void enter(Stage stage) {
    check();
    fraction_ppm_.store(0, std::memory_order_relaxed);
    moves_.store(0, std::memory_order_relaxed);
    stage_.store(stage, std::memory_order_relaxed);
    memory_.enter(stage);
  }
  /// Sets the progress within the stage, 0 to 1. Checks for cancellation.
  void progress(double fraction) {
    check();
    fraction_ppm_.store(static_cast<std::int32_t>(fraction * 1e6), std::memory_order_relaxed);
  }

  Stage stage() const { return stage_.load(std::memory_order_relaxed); }
  /// Returns the progress within the stage, 0 to 1. It is the last argument of `progress`, and a little more after each
  /// check, so that it stands still only if no work is done. It goes back only if `progress` is called with a smaller
  /// number.
  double fraction() const {
    // Code may report that the stage is done and still have work to do.
    const double told = std::min(told_fraction(), kNearlyAll);
    const double moves = static_cast<double>(moves_.load(std::memory_order_relaxed));
    return told + kShareOfMoves * (1 - told) * moves / (moves + kHalfOfMoves);
  }
  /// Returns the last argument of `progress`.
  double told_fraction() const { return fraction_ppm_.load(std::memory_order_relaxed) * 1e-6; }

  /// Returns the bound on the memory of the stage. The thread that enters stages may change it.
  MemoryBound& memory() { return memory_; }
  const MemoryBound& memory() const { return memory_; }

 private:
  /// Progress moves once in this many calls of `check` by a thread, because some code calls it for each item.
  static constexpr std::uint32_t kChecksPerMove = 16;
  static constexpr std::uint32_t kComparisonsPerMove = 1 << 14;
  /// All moves together are at most this share of the progress that is left. They reach half of that share after
  /// `kHalfOfMoves` moves. With a few thousand moves a second, each second moves progress by a millionth or more for
  /// minutes.
  static constexpr double kShareOfMoves = 0.25, kHalfOfMoves = 16000, kNearlyAll = 0.95;

  enum class Reason : std::int8_t { kNone, kCancelled, kTimeout };

  void request_stop(Reason reason) {
    Reason none = Reason::kNone;
    stop_.compare_exchange_strong(none, reason);
  }
  [[noreturn]] void throw_stopped(Reason reason) const;

  std::atomic<Reason> stop_{Reason::kNone};
  std::atomic<Stage> stage_{Stage::kQueued};
  std::atomic<std::int32_t> fraction_ppm_{0};
  mutable std::atomic<std::uint64_t> moves_{0};
  MemoryBound memory_;
};

}  // namespace remesh
