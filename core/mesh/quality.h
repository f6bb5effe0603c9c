/// Measures a surface: counts, areas, and the quality of its triangles.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/statistics.h"

namespace remesh {

/// The quality of one triangle. If its area is zero, its angle is 0, and so are its ratios (0 stands for infinite).
struct FaceQuality {
  double min_angle_deg = 0;
  double radius_edge_ratio = 0;
  double aspect_ratio = 0;
};

/// Computes the quality of every triangle, by Verdict's definitions.
/// Holds:   every number is finite. The result has the same bits for any number of threads.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(vertices + faces).
IdVector<FaceId, FaceQuality> face_quality(const TriangleMesh& mesh, RunControl& control);

/// Computes counts, areas and topology of a polygon surface.
/// - `vertices` does not count vertices that no face uses.
/// - `euler` is V - E + F of the vertices, edges and faces that are counted.
/// - `closed` means that every edge has exactly two half-edges, whether or not they run in opposite directions.
/// - `volume` is the signed volume that the surface encloses. It is empty unless the surface is closed and consistently
///   wound.
/// - `components` counts the parts of the surface. Faces that share a vertex belong to the same part.
/// - `quality`, `area` and `volume` are those of the triangles. A polygon that is not plane counts with the area and
///   the volume of its triangles. If a polygon crosses itself, the caller knows how much of their area lies on itself
///   (`Triangulated::excess_area`).
/// - Quality follows Verdict's definitions. Triangles of zero area count with angle 0. They are left out of the means
///   and maxima of ratios, so a ratio that is not finite is never reported.
/// Input:  `triangles`: the triangles that the faces are cut into, three corners each; equal to `corners` if all faces
///         are triangles.
/// Holds:  the result has the same bits for any number of threads.
MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Adjacency& adjacency,
                               std::span<const VertexId> triangles, RunControl& control);
MeshStatistics measure_surface(const TriangleMesh& mesh, RunControl& control);

}  // namespace remesh
