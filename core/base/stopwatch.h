/// Measures the time of each stage.
#pragma once

#include <array>
#include <chrono>
#include <vector>

#include "core/base/run_control.h"

namespace remesh {

struct StageTime {
  Stage stage;
  double ms;
};

/// Tells the RunControl which stage the run is in, and measures the time of each stage. The times of a stage that is
/// entered several times add up.
class Stopwatch {
 public:
  explicit Stopwatch(RunControl& control) : control_(control) {}

  void enter(Stage stage) {
    leave();
    control_.enter(stage);
    stage_ = stage;
    started_ = Clock::now();
  }
  std::vector<StageTime> finish() {
    leave();
    std::vector<StageTime> times;
    for (int s = 0; s < kStageCount; ++s)
      if (is_entered_[s]) times.push_back({static_cast<Stage>(s), ms_[s]});
    return times;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void leave() {
    if (stage_ == Stage::kQueued) return;
    ms_[static_cast<int>(stage_)] += std::chrono::duration<double, std::milli>(Clock::now() - started_).count();
    is_entered_[static_cast<int>(stage_)] = true;
    stage_ = Stage::kQueued;
  }

  RunControl& control_;
  Stage stage_ = Stage::kQueued;
  Clock::time_point started_;
  std::array<double, kStageCount> ms_{};
  std::array<bool, kStageCount> is_entered_{};
};

}  // namespace remesh
