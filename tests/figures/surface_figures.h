/// The pictures of the surfaces that are recognised, and of facets for which recognition declines.
#pragma once

#include <string>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"

namespace remesh::figures {

/// Draws the bracket and a turned part with their facets in the colours of their surfaces.
std::string recognised_surfaces(const PolygonMesh& bracket, RunControl& control);

/// Draws three parts of which some facets, or all of them, stay planes or free.
std::string declined_surfaces(RunControl& control);

}  // namespace remesh::figures
