/// Holds the result of a search for pairs of faces that intersect, and the bounds on the search.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include "core/base/ids.h"

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

}  // namespace remesh
