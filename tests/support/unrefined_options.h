/// The options of a run without refinement, which stops at the triangulation of the vertices that stay.
#pragma once

#include "core/base/options.h"

namespace remesh {

inline Options unrefined() {
  Options options;
  options.refine = false;
  return options;
}

}  // namespace remesh
