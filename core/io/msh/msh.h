/// Writes Gmsh's mesh format.
#pragma once

#include <string>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/io/common/format.h"

namespace remesh {

/// Writes `.msh` as text of version 2.2, which most programs can read. Each patch is an elementary entity. Each label
/// of the first kind that the mesh has (group, object, material) is a physical group of that name. Without labels,
/// each patch is a physical group named `patch_0`, `patch_1`, ... If the surfaces of the patches are known, each face
/// has the number of its surface in an element data section named `surface`, which Gmsh shows as a view. `comments` are
/// in a section `$Comments`.
/// Holds:  every number is the shortest text that reads back to the same double; no name can end its line.
/// Errors: kCancelled, kTimeout - through `control`.
/// Cost:   O(output).
std::string write_msh(const WriterInput& input, RunControl& control);

}  // namespace remesh
