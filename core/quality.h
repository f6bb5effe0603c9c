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
#include "core/report.h"

namespace remesh {

/// Quality of triangles, by Verdict's definitions. Zero-area triangles count with angle 0 and are left out of the
/// ratios' means and maxima (a ratio that is not finite is never reported).
/// Input:  three corners a triangle.
/// Holds:  the same bits for any number of threads.
Quality measure_quality(std::span<const Vec3> positions, std::span<const VertexId> corners, RunControl& control);

/// Quality of one triangle. Where its area is zero: angle 0, and 0 for the ratios, which would be infinite.
struct FaceQuality {
  double min_angle_deg = 0;
  double radius_edge_ratio = 0;
  double aspect_ratio = 0;
};
IdVector<FaceId, FaceQuality> face_quality(const TriangleMesh& mesh, RunControl& control);

/// Counts, areas and topology of a polygon surface. Vertices that no face uses are not counted in `vertices` here.
/// `euler` is V - E + F of what is used; `closed`: every edge has exactly two half-edges, running in opposite
/// directions or not; `volume` is the enclosed signed volume where closed and consistently wound, else empty;
/// `components` connects faces that share a vertex. `quality` is that of triangles; where not all faces are, it is left
/// as it is: see measure_quality.
MeshStatistics measure_surface(std::span<const Vec3> positions, std::span<const std::uint32_t> face_begin,
                               std::span<const VertexId> corners, const Adjacency& adjacency, RunControl& control);
MeshStatistics measure_surface(const TriangleMesh& mesh, RunControl& control);

}  // namespace remesh
