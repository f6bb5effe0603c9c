/// The pipeline's entry. It takes a surface, and gives the same surface re-triangulated, with a report.
#pragma once

#include <optional>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/version.h"
#include "core/mesh/mesh.h"
#include "core/output/result/result.h"
#include "core/verify/near_faces/compared_meshes.h"

namespace remesh {

/// The number of threads of a run. It is limited by the settings, by the process (tbb::global_control), and by the size
/// of the input (RunSettings::serial_corners).
int thread_count(const PolygonMesh& input, const Options& options, const RunSettings& settings);

/// Re-triangulates a surface: coplanar faces become patches, and patches are triangulated from their essential
/// vertices.
/// Input:   a mesh that satisfies what PolygonMesh promises; the `diagnostics` of its reader, which are passed on into
///          the report.
/// Output:  vertices with their input coordinates, bit for bit, or rounded to the settings' storage (round_for_format);
///          triangles by patch; the report, with a verdict in which all is true.
/// Holds:   the six promises of README.md; the same bytes for any number of workers.
/// Errors:  kEmptyMesh, kInvalidMesh - see prepare; kInvalidOption - see check_options; kOutputTooLarge - there are
///          more faces than allowed, or there certainly would be; kCancelled, kTimeout - asked to stop through
///          `control`; kVerificationFailed - even the last rung of the ladder failed the check; kNotAcceptable - the
///          settings' storage cannot hold the result.
/// Cost:    O(n log n) in the input's corners.
Result remesh_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                      RunControl& control, std::vector<Diagnostic> diagnostics = {});

/// Makes the report on `input` alone: statistics, patches, diagnostics, and how many faces remesh_surface makes. A
/// small surface is remeshed to count these; for others, or where that would take long, the number is a prediction.
/// Input:   as for remesh_surface.
/// Holds:   the report is the same for any number of workers, apart from the times.
/// Errors:  kEmptyMesh, kInvalidMesh - see prepare; kInvalidOption - see check_options; kCancelled, kTimeout - asked to
///          stop through `control`.
/// Cost:    O(n log n) in the input's corners. A small surface also costs what remesh_surface costs; the report counts
///          that time in the stage "refinement".
Report analyze_surface(const PolygonMesh& input, const Options& options, const RunSettings& settings,
                       RunControl& control, std::vector<Diagnostic> diagnostics = {});

/// Bounds how far two surfaces are apart, both ways, whether or not one was made from the other.
/// Input, output, holds, errors, cost: those of distance_between_meshes.
verification::TwoWayDistance compare_surfaces(const PolygonMesh& a, const PolygonMesh& b,
                                              std::optional<double> tolerance, const RunSettings& settings,
                                              RunControl& control);

}  // namespace remesh
