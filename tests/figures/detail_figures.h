/// The figure that shows how details are removed.
#pragma once

#include <string>

#include "core/base/run_control.h"

namespace remesh::figures {

/// Draws as SVG a block with small details, refined with them and without them.
std::string details(RunControl& control);

}  // namespace remesh::figures
