/// Measures how far vertices inside a patch are from the other surface: vertices of the input from the output's faces
/// above or below them, and vertices of the output from the input's faces.
#pragma once

#include <cstddef>

#include "core/base/run_control.h"
#include "core/verify/model/boundary_graph.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// The largest difference of height over the patch's plane between a dropped input vertex and the output triangle
/// that covers it. Vertices on the boundary are not measured here, because check_boundary has compared them with
/// their chords.
/// Input:  a patch with a sound frame, whose output triangles all turn counter-clockwise in their plane coordinates.
/// Output: infinity if no triangle covers one of the vertices.
/// Cost:   O(n log n): a sweep over the plane that stores in order the edges under the triangles.
double largest_height_of_dropped(const NumberedClaim& numbered, std::size_t patch, const BoundaryGraph& input_seams,
                                 RunControl& control);

/// The largest difference of height between a new vertex and the input triangle that covers it.
/// Output: infinity also if the input does not consist of triangles that all turn counter-clockwise in the plane.
double largest_height_of_new(const NumberedClaim& numbered, std::size_t patch, const BoundaryGraph& output_seams,
                             RunControl& control);

}  // namespace remesh::verification
