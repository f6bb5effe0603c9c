/// Measures how long a run goes on after it was asked to stop.
#pragma once

#include <functional>
#include <optional>

#include "core/base/run_control.h"
#include "tests/support/time_limit.h"

namespace remesh::test {

/// Cancels a run `stop_after` its beginning, and returns how much of the processor's time it then takes to end.
/// Output: nothing if the run ended before it was stopped, as it does on a fast machine.
/// Holds:  the test fails if the run ends with any error but kCancelled.
std::optional<Seconds> time_to_stop(Seconds stop_after, const std::function<void(RunControl&)>& run);

}  // namespace remesh::test
