/// The pipeline's entry: a surface in, the same surface re-triangulated out, with its report.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/version.h"
#include "core/mesh/mesh.h"
#include "core/output/result.h"

namespace remesh {

/// How many threads a run takes: as many as its settings and the process (tbb::global_control) allow, and as the input
/// is worth (RunSettings::serial_corners).
int thread_count(const PolygonMesh& input, const Options& options, const RunSettings& settings);

/// Re-triangulates a surface: coplanar faces become patches, patches are triangulated from their essential vertices.
/// Input:   a mesh that holds what PolygonMesh promises; `diagnostics` of its reader, passed on into the report.
/// Output:  vertices with their input coordinates, bit for bit, or rounded to the settings' storage (round_output);
///          triangles by patch; the report with a verdict all true.
/// Holds:   the six promises of README.md; the same bytes for any number of workers.
/// Errors:  kEmptyMesh, kInvalidMesh - see prepare; kInvalidOption - see check_options; kOutputTooLarge - more
///          faces than allowed are certain, or there; kCancelled, kTimeout - asked to stop through `control`;
///          kVerificationFailed - even the last rung of the ladder failed the check; kNotAcceptable - the settings'
///          storage cannot hold the result.
/// Cost:    O(n log n) in the input's corners.
Result remesh_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                      RunControl& control, std::vector<Diagnostic> diagnostics = {});

/// The report of `input` alone: statistics, patches, diagnostics, prediction; remeshes nothing, verifies nothing.
/// Input:   as for remesh_surface.
/// Holds:   the same report for any number of workers, but for the times.
/// Errors:  kEmptyMesh, kInvalidMesh - see prepare; kInvalidOption - see check_options; kCancelled, kTimeout - asked to
///          stop through `control`.
/// Cost:    O(n log n) in the input's corners.
Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics = {});

}  // namespace remesh
