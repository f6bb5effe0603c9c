/// How a caller watches and stops a running remesh.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

#include "core/base/error.h"

namespace remesh {

/// Shared between the thread that computes and those that watch. All members may be called from any thread.
/// Work calls `check()` often enough (every few thousand elements) that a stop is obeyed within 100 ms.
class RunControl {
 public:
  using Clock = std::chrono::steady_clock;

  /// Asks the work to stop; it ends with Code::kCancelled. The first reason given wins.
  void cancel() { request_stop(Reason::kCancelled); }
  /// Asks the work to stop because its time is over; it ends with Code::kTimeout.
  void expire() { request_stop(Reason::kTimeout); }
  bool is_stopped() const { return stop_.load(std::memory_order_relaxed) != Reason::kNone; }

  /// Errors: kCancelled or kTimeout - a stop was asked for.
  void check() const {
    const Reason reason = stop_.load(std::memory_order_relaxed);
    if (reason != Reason::kNone) throw_stopped(reason);
  }

  /// Enters a stage: progress starts again at 0. Also a point of cancellation.
  void enter(Stage stage) {
    check();
    fraction_ppm_.store(0, std::memory_order_relaxed);
    stage_.store(stage, std::memory_order_relaxed);
  }
  /// Progress within the stage, 0 to 1. Also a point of cancellation.
  void progress(double fraction) {
    check();
    fraction_ppm_.store(static_cast<std::int32_t>(fraction * 1e6), std::memory_order_relaxed);
  }

  Stage stage() const { return stage_.load(std::memory_order_relaxed); }
  double fraction() const { return fraction_ppm_.load(std::memory_order_relaxed) * 1e-6; }

 private:
  enum class Reason : std::int8_t { kNone, kCancelled, kTimeout };

  void request_stop(Reason reason) {
    Reason none = Reason::kNone;
    stop_.compare_exchange_strong(none, reason);
  }
  [[noreturn]] void throw_stopped(Reason reason) const;

  std::atomic<Reason> stop_{Reason::kNone};
  std::atomic<Stage> stage_{Stage::kQueued};
  std::atomic<std::int32_t> fraction_ppm_{0};
};

}  // namespace remesh
