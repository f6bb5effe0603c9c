/// How far a refinement is.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "core/base/run_control.h"

namespace remesh {

/// Counts the triangles that are there against those that a prediction expects. Expectations may be half of what comes:
/// then it stands at 99 %. All members may be called from any thread.
class RefinementProgress {
 public:
  RefinementProgress(RunControl& control, double expected) : control_(control), expected_(std::max(expected, 1.0)) {}

  /// A refinement begins, or begins again, with so many triangles.
  void begin(std::uint64_t faces) { faces_ = static_cast<std::int64_t>(faces); }
  /// There are so many more (or fewer) triangles. Also a point of cancellation.
  void add(std::int64_t faces) {
    const double fraction = static_cast<double>(faces_ += faces) / expected_;
    // One that begins again does not go back.
    double known = fraction_;
    while (known < fraction && !fraction_.compare_exchange_weak(known, fraction)) {
    }
    control_.progress(std::min(0.99, std::max(known, fraction)));
  }

 private:
  RunControl& control_;
  const double expected_;
  std::atomic<std::int64_t> faces_{0};
  std::atomic<double> fraction_{0};
};

}  // namespace remesh
