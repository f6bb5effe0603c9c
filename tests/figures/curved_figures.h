/// The figures that show how curved parts are remeshed.
#pragma once

#include <string>

#include "core/base/run_control.h"

namespace remesh::figures {

/// Draws a flange as SVG, with three numbers of elements per circle.
std::string elements_per_circle(RunControl& control);

/// Draws as SVG how the distance between input and result of a curved patch is proven.
std::string proven_distance();

/// Draws a surface of no kind, and what becomes of it within three distances.
std::string coarser_surfaces(RunControl& control);

}  // namespace remesh::figures
