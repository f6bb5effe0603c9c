/// How far vertices inside a patch, of one side, are from the other side's faces above or below them.
#pragma once

#include <cstddef>

#include "core/base/run_control.h"
#include "core/verify/boundary_graph.h"
#include "core/verify/model.h"

namespace remesh::verification {

/// The largest difference of height over the patch's plane between an input vertex that is gone and the output triangle
/// that covers it. Vertices on the boundary are left out: they have been held against their chords.
/// Input:  a patch with a sound frame, whose output triangles all turn counter-clockwise in their plane coordinates.
/// Output: infinity if no triangle covers one of the vertices.
/// Cost:   O(n log n): a sweep over the plane, with the edges under the triangles in order.
double largest_height_of_dropped(const Model& model, std::size_t patch, const BoundaryGraph& input_seams,
                                 RunControl& control);

/// The same for new vertices over the input's triangles.
/// Output: infinity also where the input is not made of triangles that all turn counter-clockwise in the plane.
double largest_height_of_new(const Model& model, std::size_t patch, const BoundaryGraph& output_seams,
                             RunControl& control);

}  // namespace remesh::verification
