/// What a volume mesher (TetGen, Gmsh) would refuse in a surface, and where.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/output/volume_obstacle.h"

namespace remesh {

/// Faces meet under a small dihedral angle below this.
inline constexpr double kSmallDihedralDeg = 0.1;

/// Output:  what is in the way, by code: open_boundary, non_manifold_edge and inconsistent_winding (edges),
///          duplicate_face (faces over the same vertices as an earlier one), self_intersection and overlapping_faces
///          (the given pairs, but for duplicates), small_dihedral (edges at which two faces nearly lie on each other),
///          inside_out (closed shells that look the wrong way, by their first faces). None: the surface bounds volumes.
/// Input:   three corners a face; their edges and labels; `intersections` of the faces, sorted; coplanar ones within
///          the tolerance count as overlapping.
/// Holds:   the same for any number of threads.
/// Cost:    O(n log n).
std::vector<VolumeObstacle> find_volume_obstacles(std::span<const Vec3> positions, std::span<const VertexId> corners,
                                                  const Adjacency& edges, const BodyLabels& labels,
                                                  std::span<const std::pair<FaceId, FaceId>> intersections,
                                                  double plane_tolerance, RunControl& control);

}  // namespace remesh
