/// Finds the faces of the input that intersect.
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/geometry/intersections/patch_intersections.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// Faces of a surface that intersect, in pairs.
struct FoundIntersections {
  std::vector<std::pair<FaceId, FaceId>> pairs;  ///< sorted; the smaller face first; each pair once
  bool is_complete = true;                       ///< false if the search was cut short, so there may be more pairs
  double searched = 1;                           ///< the share of the faces that were compared with all others
};

/// The search stops at this many pairs, because with more, the surface lies on itself all over. It also stops after
/// many times the number of steps that is usual for a surface of its size (SearchLimits::steps_for).
inline constexpr std::size_t kMaxIntersections = 100'000;
/// The limit for a surface with few faces is lower, because it lies on itself all over with fewer pairs, and its
/// remeshed result would have many times more.
constexpr std::size_t max_intersections(std::size_t faces) {
  constexpr std::size_t kAlways = 1 << 14, kPerFace = 16;
  return std::min(kMaxIntersections, kAlways + kPerFace * std::min(faces, kMaxIntersections));
}

/// Finds the faces that intersect, except pairs inside one large simple patch. A polygon and a face with an edge on one
/// of the polygon's diagonals count as intersecting, too. Reports pairs as self_intersection, and as overlapping_faces
/// if they are coplanar within the tolerance (model units). Elements are input faces. If the search was cut short, this
/// is reported as incomplete_check. Its count is the number of faces that were not compared with all others, and the
/// message estimates the number of all pairs.
FoundIntersections find_intersections(const Surface& surface, const Triangulated& faces, const PatchSet& patches,
                                      const std::vector<std::uint8_t>& is_simple, double plane_tolerance,
                                      std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
