/// Options of a run that stops at the triangulation of what stays.
#pragma once

#include "core/base/options.h"

namespace remesh {

inline Options unrefined() {
  Options options;
  options.refine = false;
  return options;
}

}  // namespace remesh
