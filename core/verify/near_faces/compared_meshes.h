/// How far two meshes are apart, as they were read.
#pragma once

#include <optional>

#include "core/base/run_control.h"
#include "core/mesh/mesh.h"
#include "core/verify/near_faces/near_faces.h"

namespace remesh::verification {

/// Bounds how far the points of each mesh are from the other one (see distance_between). Nothing is mended. Faces with
/// more than three corners count as the triangles that split_polygon makes of them, without spikes.
/// Input:   two meshes that satisfy what PolygonMesh promises; a tolerance in model units if yes or no is enough.
/// Output:  the distances. Faces have the numbers of their meshes. `far_count` counts triangles, and a face of more
///          corners is listed once.
/// Holds:   the same for any number of workers.
/// Errors:  kEmptyMesh - a mesh has no face; kCoordinateRange - see weld and distance_between; kCancelled, kTimeout -
///          asked to stop through `control`.
/// Cost:    as distance_between.
TwoWayDistance distance_between_meshes(const PolygonMesh& a, const PolygonMesh& b, std::optional<double> tolerance,
                                       RunControl& control);

}  // namespace remesh::verification
