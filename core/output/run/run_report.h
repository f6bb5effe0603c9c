/// Completes the report of a run and makes its result.
#pragma once

#include <memory>
#include <optional>

#include "core/output/result/result.h"
#include "core/output/run/run_products.h"

namespace remesh {

/// Makes the report of a surface that is analysed.
/// Input:   a run whose patches have been triangulated. The triangles are not part of the report, but they predict what
///          refinement would make of the patches, unless `made` says so.
/// Errors:  kCancelled, kTimeout - asked to stop.
/// Cost:    that of a prediction, and of the searches for intersections and for the smallest gap.
Report make_analysis(std::unique_ptr<RunProducts> run, std::optional<MadeFaces> made);

/// Makes the report and the result of a run whose candidate has passed verification. The result is rounded for its
/// format and then measured.
/// Errors:  kNotAcceptable - the settings' storage cannot hold the result; kCancelled, kTimeout - asked to stop.
/// Cost:    O(n log n). If there are far more faces than in the input, options are tried that would lead to fewer, each
///          at the cost of a prediction.
Result make_result(std::unique_ptr<RunProducts> run, const RunSettings& settings);

}  // namespace remesh
