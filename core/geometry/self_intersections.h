/// Finds all pairs of faces of a triangulated surface that intersect. The result is exact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
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
  bool is_complete = true;                       ///< false if the search was cut short, so there may be more pairs
  /// False if there are more pairs than are listed. If the search was complete, the pairs that are not listed are
  /// expected (SearchLimits::is_expected).
  bool are_all_listed = true;
  std::uint64_t steps = 0;  ///< the work that was done, as SearchLimits counts it
  /// The share of the faces that were compared with all faces that they might meet; 1 if the search was complete.
  double searched = 1;
  /// An estimate of the number of all pairs, if it was wanted and the search was cut short; otherwise 0. It is
  /// extrapolated from the pairs of a few faces that are spread over the surface.
  double estimated_pairs = 0;
};

/// Bounds on a search for pairs. A step is a look at a node of a tree; a test of two faces counts as several steps. So
/// the work of a search is the same on every machine and for any number of threads.
struct SearchLimits {
  static constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
  /// The max number of pairs for a search that only has to show that a surface crosses itself, and roughly where.
  static constexpr std::size_t kEnoughPairs = 100'000;

  SearchLimits(std::size_t pairs, std::uint64_t steps = kNoLimit) : max_pairs(pairs), max_steps(steps) {}

  /// A bound that is in proportion to n log n for n faces. Surfaces of well-shaped faces take less than a hundredth of
  /// these steps.
  static std::uint64_t steps_for(std::size_t faces);
  /// An eighth of these steps. That is enough to show where a surface intersects, if nothing is proven from it.
  static std::uint64_t few_steps_for(std::size_t faces) { return steps_for(faces) / 8; }

  std::size_t max_pairs;
  std::uint64_t max_steps;  ///< the search ends soon after it has taken more steps than this
  /// If this is set, pairs for which it returns true do not end the search. After the first `max_pairs` pairs they are
  /// neither listed nor tested. It is called from several threads.
  std::function<bool(FaceId, FaceId)> is_expected = {};
  /// With `is_expected`, the search ends soon after it has found more pairs than this that are not expected.
  std::size_t max_unexpected = std::numeric_limits<std::size_t>::max();
  /// After more steps than this, a single such pair ends the search.
  std::uint64_t max_steps_with_unexpected = kNoLimit;
  bool is_estimate_wanted = false;  ///< if the search is cut short, the number of pairs is estimated
};

/// The entry of `pieces` for a face that is tested against all other faces.
inline constexpr std::uint32_t kNoPiece = 0xffffffffu;

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
