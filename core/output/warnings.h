/// Diagnostics about the run as a whole.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Warns where most facets are patches of their own. They stand for a curved surface then, and a bound on angles or
/// sizes in each of them makes many faces.
void warn_of_curves(const Surface& surface, const PatchSet& patches, std::vector<Diagnostic>& diagnostics);

/// Adds to the diagnostic of intersections that there are too many for the verdict to be about all of them.
void warn_of_many_intersections(std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
