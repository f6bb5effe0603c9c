/// A run in a thread of its own that is watched and may be stopped, with how long it lived after that.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/run_control.h"

namespace remesh::mutate {

enum class Ending {
  kDone,
  kRefused,      ///< by an Error
  kOutOfMemory,  ///< by bad_alloc, which the service answers with a code of its own
  kStrange,      ///< by any other exception
  kNever,        ///< it was asked to stop and did not: its thread still runs, and the process has to end
};

struct RunEnd {
  Ending ending = Ending::kDone;
  std::optional<Error> error;  ///< of kRefused
  std::string strange;         ///< of kStrange: type and message
  double wall_s = 0;
  bool was_stopped = false;      ///< while it ran
  Stage stage = Stage::kQueued;  ///< in which the stop arrived
  double stop_wall_ms = 0;       ///< from the stop to the end
  double stop_busy_ms = 0;       ///< the processor time of that, of the run's own thread or a worker's share: what a
                                 ///< machine without other work would have needed
};

/// Runs `work` and asks it to stop after `stop_after_s`.
/// Output: what became of it; kNever where it lives for `patience_s` after the stop.
RunEnd run_watched(const std::function<void(RunControl&)>& work, double stop_after_s, double patience_s, int workers);

}  // namespace remesh::mutate
