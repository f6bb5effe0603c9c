/// Progress of long loops within a stage.
#pragma once

#include <cstddef>
#include <mutex>

#include "core/base/run_control.h"

namespace remesh {

/// Reports the progress of a loop. The rest of the stage's work is unknown, so a loop takes a share of the progress
/// that is left when it begins. Progress never goes back. Several threads may add at once.
class LoopProgress {
 public:
  /// Input: `total` items will be added.
  LoopProgress(RunControl& control, std::size_t total)
      : control_(control), from_(control.told_fraction()), total_(static_cast<double>(total > 0 ? total : 1)) {}

  /// Counts some items as done.
  /// Errors: kCancelled, kTimeout - asked to stop.
  void add(std::size_t items) {
    const std::lock_guard lock(mutex_);
    done_ += items;
    constexpr double kShare = 0.125;
    control_.progress(from_ + (1 - from_) * kShare * (static_cast<double>(done_) / total_));
  }

 private:
  RunControl& control_;
  const double from_, total_;
  std::mutex mutex_;
  std::size_t done_ = 0;
};

}  // namespace remesh
