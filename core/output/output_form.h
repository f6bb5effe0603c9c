/// A verified result in the numbers that its output format can hold, and what is reported of it then.
#pragma once

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/output/result.h"

namespace remesh {

/// The largest share of the input's diagonal by which an output format may move a vertex. Where the plane tolerance is
/// larger, that bounds the move. Smaller, and parts at ordinary coordinates would not be written as binary STL; larger,
/// and thin walls would lose a visible part of their thickness.
inline constexpr double kAllowedRounding = 1e-6;

/// Measures the result as it stands: fills the report's `output`, `volume_obstacles` and `unrefined`.
/// Input:   a mesh, its basis, the intersections of its verdict, and its `output_origin`.
/// Holds:   places and the bounding box are the model's, also where the mesh is relative to an origin.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
void measure_output(Result& result, RunControl& control);

/// Rounds a verified result to the numbers of a storage, checks what has become of it (verify/stored_form.h), and
/// changes the report with it: rounding, origin, deviation, volume bound, intersections. To be measured again if its
/// points have changed.
/// Input:   a result in doubles, as remesh_surface gives it; `local_origin`: may the points be relative to an origin
///          near the part, where they do not hold as they are?
/// Output:  whether any point has changed. The mesh's positions are then numbers of the storage, relative to the
///          report's output_origin if there is one.
/// Holds:   where every point is at hand in the storage, nothing changes. The same for any number of threads.
/// Errors:  kNotAcceptable - the storage cannot hold the result; the message says why, how far apart the storage's
///          numbers are there, and what would do. kVerificationFailed - the list of faces that rounding costs fails its
///          check; kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n).
bool round_output(Storage storage, bool local_origin, Result& result, RunControl& control);

}  // namespace remesh
