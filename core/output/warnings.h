/// Makes diagnostics on the run as a whole.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/geometry/patch_set.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Warns if most facets are patches of their own. Then they stand for a curved surface, and a bound on angles or sizes
/// makes many faces in each of them.
void warn_of_curves(const Surface& surface, const PatchSet& patches, std::vector<Diagnostic>& diagnostics);

/// Adds to the diagnostic on intersections that there are too many of them for the verdict to cover all.
void warn_of_many_intersections(std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
