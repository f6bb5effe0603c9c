/// Measures of a surface: counts, areas, and the quality of its triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/statistics.h"

namespace remesh {

/// Quality of one triangle. Where its area is zero: angle 0, and 0 for the ratios, which would be infinite.
struct FaceQuality {
  double min_angle_deg = 0;
  double radius_edge_ratio = 0;
  double aspect_ratio = 0;
};

/// The quality of every triangle, by Verdict's definitions.
/// Holds:   every number is finite; the same bits for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(vertices + faces).
IdVector<FaceId, FaceQuality> face_quality(const TriangleMesh& mesh, RunControl& control);

/// Counts, areas and topology of a polygon surface. Vertices that no face uses are not counted in `vertices` here.
/// `euler` is V - E + F of what is used; `closed`: every edge has exactly two half-edges, running in opposite
/// directions or not; `volume` is the enclosed signed volume where closed and consistently wound, else empty;
/// `components` connects faces that share a vertex. `quality`, `area` and `volume` are those of triangles: a polygon
/// without a plane has no other area, and bounds no other volume, than the triangles that it is taken for; where one
/// crosses itself, the caller knows how much of their area lies on itself (`Triangulated::excess_area`). Quality is by
/// Verdict's definitions; zero-area triangles count with angle 0 and are left out of the ratios' means and maxima (a
/// ratio that is not finite is never reported).
/// Input:  `triangles`: those that the faces are cut into, three corners each; `corners` where all faces are triangles.
/// Holds:  the same bits for any number of threads.
MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Adjacency& adjacency,
                               std::span<const VertexId> triangles, RunControl& control);
MeshStatistics measure_surface(const TriangleMesh& mesh, RunControl& control);

}  // namespace remesh
