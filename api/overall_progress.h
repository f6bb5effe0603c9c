/// One number for the progress of a whole run, made of the progress of its stages.
#pragma once

#include <mutex>
#include <optional>

#include "core/base/error.h"
#include "core/base/run_control.h"

namespace remesh::api {

/// Follows a run. Each stage has its usual share of the time. If the run goes back to an earlier stage, for another
/// attempt, what is left of the progress is shared out anew. Several threads may look at once.
class OverallProgress {
 public:
  /// Returns the progress of the run, 0 to 1.
  /// Holds:  it never goes back.
  double look(const RunControl& control) { return look(control.stage(), control.fraction()); }
  /// Input: the stage that the run is in, and the progress within it, 0 to 1.
  double look(Stage stage, double fraction);

 private:
  std::mutex mutex_;
  Stage stage_ = Stage::kQueued;  ///< the last one that was seen
  bool has_result_ = false;       ///< refinement or assembly was seen
  double shared_out_ = 0;         ///< the progress at the last return to an earlier stage
  double from_ = 0;               ///< the beginning of that stage in a usual run
  double most_ = 0;               ///< the largest progress that was told
};

/// Estimates how long a run still takes, from its overall progress and the time it has taken.
/// Output: nothing as long as there is too little of both.
std::optional<double> seconds_left(double overall, double elapsed_s);

}  // namespace remesh::api
