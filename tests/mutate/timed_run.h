/// Runs work in a thread that is watched and may be stopped, and measures how long it lived after the stop.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/base/error.h"
#include "core/base/run_control.h"

namespace remesh::mutate {

enum class Ending {
  kDone,
  kRefused,      ///< it threw an Error
  kOutOfMemory,  ///< it threw bad_alloc, which the service answers with a code of its own
  kStrange,      ///< it threw any other exception
  kNever,        ///< it was asked to stop and did not: its thread still runs, and the process must end
};

/// A time for which a caller saw no progress: neither another stage nor another millionth of one.
struct Stand {
  double after_s = 0;  ///< since the run began
  double wall_s = 0;
  double busy_s = 0;  ///< the processor time of the run's own thread meanwhile
  Stage stage = Stage::kQueued;
};

struct RunEnd {
  Ending ending = Ending::kDone;
  std::optional<Error> error;  ///< the error, for kRefused
  std::string strange;         ///< type and message of the exception, for kStrange
  double wall_s = 0;
  double busy_s = 0;             ///< processor time of all threads, which is about the time on one core
  bool was_stopped = false;      ///< it was stopped while it ran
  Stage stage = Stage::kQueued;  ///< the stage in which the stop arrived
  double stop_wall_ms = 0;       ///< time from the stop to the end
  /// The time that a machine without other work would have needed from the stop to the end. It is the processor time of
  /// the run's own thread or, if that is larger, an equal share of the process's time for each worker.
  double stop_busy_ms = 0;
  Stand longest_stand;  ///< before the stop
};

/// Runs `work` and asks it to stop after `stop_after_s`.
/// Output: the end of the run; kNever if it is still alive `patience_s` after the stop.
RunEnd run_watched(const std::function<void(RunControl&)>& work, double stop_after_s, double patience_s, int workers);

}  // namespace remesh::mutate
