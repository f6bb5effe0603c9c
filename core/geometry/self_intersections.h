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

/// The piece of a face that is held against all others.
inline constexpr std::uint32_t kNoPiece = 0xffffffffu;

/// Finds the pairs of faces that meet anywhere but in shared vertices and edges, touching included (`do_intersect`).
/// Input:   finite positions of any magnitude, welded: vertices with equal coordinates are one. `pieces`, if not empty,
///          has one entry a face: faces of one piece are not held against each other.
/// Output:  all pairs; or, of more than `max_pairs`, just so many: those that share no vertex of very many faces come
///          first, then those at edges of such, then those at such a vertex.
/// Holds:   the same result for any number of threads; exact as long as every coordinate that is not 0 is at least
///          2^-499 of the largest. Faces without area are the sets of their points.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) for the tree, then for each face O(log n) and what has a box that meets its own: a handful on a
///          surface of well-shaped faces. Where that is more than 64 faces that it does not meet for many, as where
///          needles lie side by side askew to the axes, boxes along the faces (OrientedBoxes) tell them apart. Around
///          a vertex with many faces, these are held against each other by their directions from it instead, so a fan
///          of k needles costs O(k log k); and at an edge between two such vertices, by half-planes about it, so
///          a book of k pages does, too. What has only one of the two is told apart by its angles about the edge
///          (AxialBounds) where boxes do not. Runs on the caller's TBB arena. Memory for at most 65 times max_pairs.
SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                     std::span<const std::uint32_t> pieces, std::size_t max_pairs, RunControl& control);

}  // namespace remesh
