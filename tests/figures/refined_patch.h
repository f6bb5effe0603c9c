/// The figures that show the refinement stage.
#pragma once

#include <string>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "tests/figures/part.h"

namespace remesh::figures {

/// One patch before, during and after the refinement of all patches, and the same with a largest edge; as SVG.
std::string refinement_of_patch(const Part& part, PatchId patch, RunControl& control);

/// A facet with a sharp corner and a largest edge, without and with a bound on angles; as SVG.
std::string sharp_corner(RunControl& control);

}  // namespace remesh::figures
