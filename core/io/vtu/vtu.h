/// Writes VTK's XML format for unstructured grids.
#pragma once

#include <string>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Writes a `.vtu` file: triangles, coordinates as doubles, arrays as base64. The cell data of each face are:
/// `patch`; `surface`, if the patches' surfaces are known; `min_angle_deg`, `radius_edge_ratio` and `aspect_ratio` by
/// the definitions of the Verdict library (0 where the area is zero and a ratio would be infinite); `object`, `group`
/// and `material` if the mesh has them, as numbers. The names for these numbers are in XML comments, and if there are
/// at most 1,000 of a kind, they are those of the components of an array `object_names`, `group_names` or
/// `material_names` in the field data. `comments` are in XML comments.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_vtu(const WriterInput& input, RunControl& control);

}  // namespace remesh
