/// Makes the diagnostic many_faces: why a result has far more faces than the input, where, and what would change that.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/mesh/surface.h"
#include "core/output/report/warnings.h"
#include "core/patch_types/patch_set.h"
#include "core/refinement/goals/goals.h"

namespace remesh {

/// A result, or a prediction of one, whose number of faces is to be explained.
struct FacesToExplain {
  const Surface& surface;
  const PatchSet& patches;
  RefinedFaces faces;             ///< faces of each patch of the result
  std::uint64_t input_triangles;  ///< a polygon counts as the triangles that fill it
  double diagonal;                ///< of the input's bounding box, in model units
  const Options& options;         ///< as they were given
  const Goals& goals;             ///< as they were in force
  /// The number of triangles of the result that miss the goals because of the floor under the lengths of edges.
  std::uint64_t left_by_min_edge = 0;
  /// Returns whether a patch is a facet of a curved surface.
  std::function<bool(PatchId)> is_curved_facet;
  /// Predicts the number of faces with other goals.
  std::function<double(const Goals&)> predict;
  /// Predicts the number of faces by the number of elements per circle (predict_by_elements_per_circle).
  std::function<std::map<int, std::uint64_t>()> predict_by_circles;
};

/// A result with target_faces is explained if it has more faces than that by a tenth. Another one is explained if it
/// has more faces than kTimesOfInput times the input's triangles, and more than kFewFacesAlways.
inline constexpr double kTimesOfInput = 10, kFewFacesAlways = 1000;

/// Explains a result that has many faces, or for which a value of min_edge_length was found that keeps it in proportion
/// (keep_in_proportion).
/// - The cause is the goal without which the fewest faces are predicted: sizes, gaps, or angles. For angles it is told
///   whether most faces are in facets of curved surfaces.
/// - For each option that helps, the message has the first value, in steps, with which no more than kTimesOfInput times
///   the input's triangles, or kFewFacesAlways, are predicted. If there is none, it has the one with the fewest faces,
///   if they are at least a fifth fewer. Predictions are scaled by the ratio of the result to what is predicted for it.
/// - If a value of min_edge_length was found, the message has this value, the number of triangles that it left, and the
///   number of faces that are predicted without it. If the result has few faces, the message also has the first values
///   of other options with which so few faces are predicted that no floor is needed.
/// Output:  nothing, or one diagnostic. Its elements are the input's faces of the patches with the largest shares,
///          which have half of all faces together.
/// Cost:    At most some twenty predictions, where there is something to explain, and no more than about five where
///          sizes vary on an input of more than some thousand triangles.
void explain_face_count(const FacesToExplain& result, std::vector<Diagnostic>& diagnostics);

}  // namespace remesh
