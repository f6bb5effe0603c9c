/// How far the inner vertices of a patch are from the output below them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/verify/model.h"

namespace remesh::verification {

/// The largest difference of height over the patch's plane between an input vertex that is gone and the output triangle
/// that covers it. Vertices on the boundary are left out: they have been held against their chords.
/// Input:  a patch with a sound frame, whose output triangles all turn counter-clockwise in their plane coordinates.
/// Output: infinity if no triangle covers one of the vertices.
/// Cost:   O(n log n): a sweep over the plane, with the edges under the triangles in order.
double largest_height_difference(const Model& model, std::size_t patch, std::span<const std::uint8_t> is_on_boundary,
                                 RunControl& control);

}  // namespace remesh::verification
