/// Finds what a volume mesher (TetGen, Gmsh) would refuse in a surface, and where.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/shells/shells.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/output/report/volume_obstacle.h"

namespace remesh {

/// A dihedral angle between faces is small if it is below this.
inline constexpr double kSmallDihedralDeg = 0.1;

/// Finds what keeps a surface from bounding volumes.
/// Input:   three corners per face, their edges and labels; `intersections` of the faces, sorted. Faces that are
///          coplanar within the tolerance count as overlapping.
/// Output:  the obstacles, by code. If there is none, the surface bounds volumes.
///          - open_boundary, non_manifold_edge and inconsistent_winding count edges. An edge with more than two faces
///            counts only if one of these has the same cell on both sides. If faces intersect or lie on each other,
///            cells are not known, and all such edges count.
///          - duplicate_face counts faces over the same vertices as an earlier one.
///          - self_intersection and overlapping_faces count the given pairs, without duplicates.
///          - small_dihedral counts edges at which two faces nearly lie on each other.
///          - inside_out counts closed shells that have the wrong orientation, by their first faces. A shell between
///            two closed cells that hang together may have either.
/// Holds:   the result is the same for any number of threads.
/// Cost:    O(n log n).
std::vector<VolumeObstacle> find_volume_obstacles(std::span<const Vec3> positions, std::span<const VertexId> corners,
                                                  const Adjacency& edges, const BodyLabels& labels,
                                                  std::span<const std::pair<FaceId, FaceId>> intersections,
                                                  double plane_tolerance, RunControl& control);

/// Adds an obstacle if only a share of the faces was held against all others. A surface that may intersect itself is
/// not ready. The obstacle counts the other faces.
void add_incomplete_check(double searched, std::size_t faces, std::vector<VolumeObstacle>& obstacles);

}  // namespace remesh
