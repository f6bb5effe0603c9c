/// Checks input faces of a patch that point against its plane's normal. The patch is folded over there.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/verify/model.h"

namespace remesh::verification {

/// The largest distance between a dropped vertex of such faces and the output's triangles of that patch. A region
/// that a fold covers twice, once from each side, counts neither in the patch's area nor for its boundary. Only this
/// distance tells whether the surface has lost it.
/// Input:  `folded` - these faces of the input.
/// Cost:   O(n log n) for n triangles of the output, if any vertex was dropped.
double farthest_of_folded(const Model& model, std::size_t patch, std::span<const std::uint32_t> folded,
                          RunControl& control);

}  // namespace remesh::verification
