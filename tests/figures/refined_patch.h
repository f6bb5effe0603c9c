/// The figures that show the refinement stage.
#pragma once

#include <string>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "tests/figures/part.h"

namespace remesh::figures {

/// Draws one patch as SVG before, during and after the refinement of all patches, and the same patch with a largest
/// edge.
std::string refinement_of_patch(const Part& part, PatchId patch, RunControl& control);

/// Draws a facet with a sharp corner and a largest edge as SVG, without and with a bound on angles.
std::string sharp_corner(RunControl& control);

}  // namespace remesh::figures
