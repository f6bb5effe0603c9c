/// Cuts the triangles of a soup by a plan.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/solids/cut_plan.h"
#include "core/solids/soup.h"

namespace remesh {

/// The triangles after a cut.
struct CutSoup {
  std::vector<Triangle> faces;
  std::vector<std::uint32_t> cover_begin{0};
  std::vector<Cover> covers;
  std::vector<std::uint8_t> is_active;  ///< by face: it was cut, has another corner, or was active before
  /// The number of faces that could not be cut as planned, since rounding has moved their points. Their sides are cut,
  /// so neighbours agree.
  std::size_t failed = 0;
};

/// Cuts all faces along the points and constraints of a plan. Faces in one plane are triangulated together, so that
/// they get the same triangles where they lie on each other. Triangles with equal corners become one.
/// Input:   the positions of the soup include the plan's new points. `active` is empty, or names faces.
/// Holds:   two faces with a common side have the same points on it. The result is the same for any number of threads.
/// Errors:  kOutOfMemory - see MemoryBound; kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) for n faces and points, and for each face of a plane the triangles that it covers.
CutSoup cut_faces(const Soup& soup, const SoupEdges& edges, CutPlan& plan, std::span<const std::uint8_t> active,
                  RunControl& control);

}  // namespace remesh
