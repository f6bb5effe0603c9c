/// The verdict of the independent checker.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/ids.h"

namespace remesh {

/// The largest distance of a point of the result from the input, and of a point of the input from the result, as far as
/// it was proven. In model units.
struct DistanceBound {
  double output_to_input = 0, input_to_output = 0;
  friend bool operator==(const DistanceBound&, const DistanceBound&) = default;
};

/// The result of the check. `quality` is empty without refinement.
struct Verdict {
  bool surface = false;
  bool conforming = false;
  bool delaunay = false;
  std::optional<bool> quality;
  double deviation = 0;              ///< largest distance found between input and output
  DistanceBound distance_bound;      ///< proven for the whole surface
  std::vector<double> patch_bounds;  ///< the proven distance between input and output, both ways, one per patch
  double volume_bound = 0;  ///< bound on the change of volume if both meshes are closed, from deviations and rounding
  /// The patches on which a test failed, ascending. It is empty if only a property of the whole mesh failed.
  std::vector<PatchId> failed_patches;
  /// Pairs of output faces that intersect, sorted. If there are very many, only some of them are listed.
  std::vector<std::pair<FaceId, FaceId>> intersections;
  /// False if the input has so many intersections that it is unknown for some pairs of output faces whether their
  /// patches intersect in the input. Also false if the output has very many intersections that its input does not have.
  bool are_all_intersections_known = true;
  bool are_all_intersections_listed = true;  ///< false if `intersections` has only some
  /// The share of the output faces that were compared with all others; below 1 only if the input has too many
  /// intersections to know them all.
  double searched = 1;
  std::uint64_t search_steps = 0;  ///< the work of the search for intersections, as SearchLimits counts it
  /// Descriptions of the first failures, for logs and tests.
  std::vector<std::string> failures;

  bool all_true() const { return surface && conforming && delaunay && quality.value_or(true); }
};

}  // namespace remesh
