/// Finds the faces of the input that intersect.
#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/geometry/patch_intersections.h"
#include "core/geometry/patch_set.h"
#include "core/mending/triangulated.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Faces of a surface that intersect, in pairs.
struct FoundIntersections {
  std::vector<std::pair<FaceId, FaceId>> pairs;  ///< sorted, the smaller face first, each pair once
  bool is_complete = true;                       ///< false: there are more
};

/// At most so many pairs are looked for: beyond, the surface lies on itself all over.
inline constexpr std::size_t kMaxIntersections = 100'000;

/// Finds the faces that intersect, but for those inside one large simple patch; a polygon and a face with an edge on
/// one of its diagonals are such, too. Reports self_intersection and overlapping_faces (coplanar within the tolerance,
/// model units): pairs; elements are input faces.
FoundIntersections find_intersections(const Surface& surface, const Triangulated& faces, const PatchSet& patches,
                                      const std::vector<std::uint8_t>& is_simple, double plane_tolerance,
                                      std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
