/// What is found in the input without changing it.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_intersections.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/report.h"
#include "core/stages/patches.h"

namespace remesh {

/// Reports, from a welded surface: non_manifold_edge and open_boundary (elements: the input faces at such edges), and
/// non_manifold_vertex (elements: vertices where faces meet that are not connected there over edges).
void find_defects(const Surface& welded, const Adjacency& edges, std::vector<Diagnostic>& diagnostics,
                  RunControl& control);

/// A surface's faces as triangles.
struct Triangulated {
  std::vector<Triangle> triangles;
  std::vector<FaceId> face;  ///< of each triangle; ascending
};

/// The faces as triangles, polygons split by split_polygon; for measuring the quality of the input.
Triangulated triangulated(const Surface& surface, RunControl& control);

/// Faces of a surface that intersect, in pairs.
struct FoundIntersections {
  std::vector<std::pair<FaceId, FaceId>> pairs;  ///< sorted, the smaller face first, each pair once
  bool is_complete = true;                       ///< false: there are more
};

/// At most so many pairs are looked for: beyond, the surface lies on itself all over.
inline constexpr std::size_t kMostIntersections = 100'000;

/// Finds the faces that intersect, but for those inside one large simple patch, and reports self_intersection and
/// overlapping_faces (coplanar within the tolerance, model units): pairs; elements are input faces.
FoundIntersections find_intersections(const Surface& surface, const Triangulated& faces, const PatchSet& patches,
                                      const std::vector<std::uint8_t>& is_simple, double plane_tolerance,
                                      std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
