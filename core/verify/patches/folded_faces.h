/// Checks input faces of a patch that point against its plane's normal. The patch is folded over there.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// Measures the distance of such faces from the output's triangles of that patch. A region that a fold covers twice,
/// once from each side, counts neither in the patch's area nor for its boundary. Only this distance shows whether the
/// surface has lost that region.
/// Input:  `folded` - these faces of the input; `known` - a distance between input and output that is known already.
/// Output: the largest distance of a dropped vertex, and of places inside the faces. Faces are divided where they may
///         hold places that are farther than both `known` and the largest distance so far, but not without end: the
///         result may be too small by a 16th of the longest edge of a folded face, and by up to half of it if there are
///         many folded faces.
/// Cost:   O((n + f) log n) for n triangles of the output and f folded faces.
double farthest_of_folded(const NumberedClaim& numbered, std::size_t patch, std::span<const std::uint32_t> folded,
                          double known, RunControl& control);

}  // namespace remesh::verification
