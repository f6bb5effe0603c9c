/// Completes the report of a run and makes its result.
#pragma once

#include "core/output/result/result.h"
#include "core/output/run/run_state.h"

namespace remesh {

/// Completes the report of a surface that is analysed and not remeshed.
/// Input:   a run whose patches have been triangulated. The triangles are not part of the report, but they predict what
///          refinement would make of the patches.
/// Errors:  kCancelled, kTimeout - asked to stop.
/// Cost:    that of a prediction, and of the searches for intersections and for the smallest gap.
void report_analysis(RunState& run);

/// Completes the report of a run whose candidate has passed verification.
/// Errors:  kCancelled, kTimeout - asked to stop.
/// Cost:    that of a prediction. If there are far more faces than in the input, options are tried that would lead to
///          fewer.
void report_remeshing(RunState& run);

/// Makes the result of the verified candidate, rounds it for its format, and measures the rounded result.
/// Input:   a run whose report is complete. It must not be used afterwards.
/// Errors:  kNotAcceptable - the settings' storage cannot hold the result; kCancelled, kTimeout - asked to stop.
/// Cost:    O(n log n).
Result make_result(RunState& run, const RunSettings& settings);

}  // namespace remesh
