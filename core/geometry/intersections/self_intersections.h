/// Finds all pairs of faces of a triangulated surface that intersect. The result is exact.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/intersections/search_limits.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Finds the pairs of faces that meet anywhere but in shared vertices and edges. Touching counts, too (`do_intersect`).
/// Input:   finite positions of any magnitude, welded: vertices with equal coordinates are one. `pieces` is empty or
///          has one entry per face: faces of one piece are not tested against each other.
/// Output:  all pairs. If there are more than `max_pairs`, or if the search takes more than `max_steps`, only the pairs
///          that were found until then. Pairs that share no vertex of very many faces come first, then pairs at edges
///          between two such vertices, then pairs at one such vertex.
/// Holds:   the result is the same for any number of threads. It is exact as long as every coordinate that is not 0 is
///          at least 2^-499 of the largest. A face without area counts as the set of its points.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n) for the tree, then for each face O(log n) and the number of faces whose boxes meet its own. On a
///          surface of well-shaped faces these are a handful. Runs on the caller's TBB arena. Takes memory for at most
///          65 times max_pairs, and some 150 bytes a face, 300 with a second tree. Whatever the surface, the search
///          ends soon after `max_steps`. Four means keep the cost low on other surfaces:
///          - If many faces have more than 64 others in their boxes without meeting them, boxes along the faces
///            (OrientedBoxes) separate them, in a second tree that is split by their shapes (split_by_shape). This
///            happens where needles lie side by side, askew to the axes, or reach below many small faces.
///          - Around a vertex with many faces, these are compared by their directions from it, so a fan of k needles
///            costs O(k log k).
///          - At an edge between two such vertices, faces are compared by their half-planes about it, so a book of k
///            pages costs O(k log k), too.
///          - Faces that have only one of two such vertices are separated by their angles about the edge (AxialBounds)
///            if boxes do not separate them.
SelfIntersections self_intersections(std::span<const Vec3> positions, std::span<const Triangle> faces,
                                     std::span<const std::uint32_t> pieces, const SearchLimits& limits,
                                     RunControl& control);

}  // namespace remesh
