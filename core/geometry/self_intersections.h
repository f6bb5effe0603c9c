/// All pairs of faces of a triangulated surface that intersect, exactly.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

struct SelfIntersections {
  std::vector<std::pair<FaceId, FaceId>> pairs;  ///< (f, g) with f < g, sorted
  bool is_complete = true;                       ///< false: there are more than `max_pairs`
};

/// Finds the pairs of faces that meet anywhere but in shared vertices and edges, touching included (`do_intersect`).
/// Input:   finite positions of any magnitude, welded: vertices with equal coordinates are one. `moved`, if not null,
///          has one entry a face: then only pairs in which at least one face is marked (not 0) count.
/// Output:  all pairs; or, of more than `max_pairs`, just so many, found first in the order of the TriangleTree.
/// Holds:   the same result for any number of threads; exact as long as every coordinate that is not 0 is at least
///          2^-499 of the largest. Faces without area are the sets of their points.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) for the tree, then for each face, or each marked one, O(log n) and what has a box that meets its
///          own. That is a handful on a surface of well-shaped faces, but all of them where needles lie side by side
///          askew to the axes or around one vertex: a fan of k needles costs k^2 tests. Runs on the caller's TBB arena.
///          Memory for at most 65 times max_pairs.
SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                     const std::vector<std::uint8_t>* moved, std::size_t max_pairs,
                                     RunControl& control);

}  // namespace remesh
