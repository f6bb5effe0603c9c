/// The progress of a refinement.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "core/base/run_control.h"

namespace remesh {

/// Derives the progress from the number of triangles and the predicted number. There may be twice as many as predicted;
/// then the progress stands at 95 %. All members may be called from any thread.
class RefinementProgress {
 public:
  RefinementProgress(RunControl& control, double expected) : control_(control), expected_(std::max(expected, 1.0)) {}

  /// Must be called when a refinement begins, or begins again, with this number of triangles.
  void begin(std::uint64_t faces) { faces_ = static_cast<std::int64_t>(faces); }
  /// Must be called when there are this many more (or fewer) triangles. It is also a point of cancellation.
  void add(std::int64_t faces) {
    const double fraction = static_cast<double>(faces_ += faces) / expected_;
    // The progress never goes back, even if the refinement begins again.
    double known = fraction_;
    while (known < fraction && !fraction_.compare_exchange_weak(known, fraction)) {
    }
    control_.progress(std::min(0.95, std::max(known, fraction)));
  }

  void check() const { control_.check(); }

 private:
  RunControl& control_;
  const double expected_;
  std::atomic<std::int64_t> faces_{0};
  std::atomic<double> fraction_{0};
};

}  // namespace remesh
