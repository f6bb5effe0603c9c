/// Input faces of a patch that look away from its plane's front: the patch is folded over there.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/verify/model.h"

namespace remesh::verification {

/// The largest distance between a vertex of such faces that is gone and the output's triangles of that patch. What a
/// fold covers twice, once from each side, is neither in the patch's area nor inside its boundary: only this tells
/// whether the surface has lost it.
/// Input:  `folded`: these faces, of the input.
/// Cost:   O(n log n) for n triangles of the output, if a vertex is gone at all.
double farthest_of_folded(const Model& model, std::size_t patch, std::span<const std::uint32_t> folded,
                          RunControl& control);

}  // namespace remesh::verification
