/// Rounds a verified result to the numbers that its output format can hold, and measures it for the report.
#pragma once

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/output/result/result.h"

namespace remesh {

/// The distance by which an output format may move a vertex, relative to the input's diagonal. If the plane tolerance
/// is larger, that is the bound instead. If this were smaller, parts at ordinary coordinates could not be written as
/// binary STL; if it were larger, thin walls would lose a visible part of their thickness.
inline constexpr double kAllowedRounding = 1e-6;

/// Measures the result: fills the report's `output`, `volume_obstacles` and `unrefined`.
/// Input:   a mesh, its basis, the intersections of its verdict, and its `output_origin`.
/// Holds:   places and the bounding box are in the model's coordinates, even if the mesh is relative to an origin.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
void measure_output(Result& result, RunControl& control);

/// Says what round_for_format has done.
enum class Rounded : std::uint8_t {
  kUnchanged,  ///< the storage holds every point as it is
  kMoved,      ///< points have moved, or are relative to an origin
  kNotHeld,    ///< the storage cannot hold the result, which has kept its doubles
};

/// Rounds a verified result to the numbers of a storage, and checks the rounded result (verify/rounded_check.h).
/// Updates the report: rounding, origin, deviation, volume bound and intersections. If points have changed, the result
/// has to be measured again.
/// Input:   a result in doubles, as remesh_surface makes it. `local_origin` says whether the points may be relative to
///          an origin near the mesh if they fail the check otherwise. `rounding` is kRequired or kIfHeld.
/// Output:  what was done. If points have changed, the mesh's positions are numbers of the storage, relative to the
///          report's output_origin if there is one. If the storage cannot hold the result, the report gets the
///          diagnostic output_as_text, which says why.
/// Holds:   if the storage holds every point exactly, nothing changes. The result is the same for any number of
///          threads.
/// Errors:  kNotAcceptable - the storage cannot hold the result, though that is required; the message says why, how
///          far apart the storage's numbers are there, and what would help. kVerificationFailed - the list of faces
///          that miss the goals after rounding fails its check. kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
Rounded round_for_format(Storage storage, bool local_origin, OutputRounding rounding, Result& result,
                         RunControl& control);

}  // namespace remesh
