/// Estimates the number of faces of a remeshing with other numbers of elements per circle.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/chains/curve_cuts.h"
#include "core/patches/charts/patch_chart.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// The numbers of elements per circle for which faces are predicted.
inline constexpr std::array kPredictedElements = {8, 12, 16, 24, 36};

/// A refined area has this number of faces per equilateral triangle of the size asked for.
inline constexpr double kFacesPerSize = 1.45;

/// Returns how many faces fill a curved patch if edges turn as far as they may; 0 for a planar patch.
/// Input:  `by_angle` says whether angles have a bound.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n) for n triangles of the patch.
double faces_by_turn(const PatchMesh& patch, const PatchChart& chart, bool by_angle, RunControl& control);

/// The facets of a surface and their recognised surfaces.
struct RecognisedFacets {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& facets;  ///< planar patches
  const RecognisedSurfaces& surfaces;
  double plane_tolerance;  ///< model units
  double diagonal;         ///< of the input's bounding box
};

/// The patches that the options of a run make.
struct PresentPatches {
  const PatchSet& patches;  ///< the facets, or the patches after facets were joined
  const EssentialVertices& essential;
  const CurveCuts& cuts;          ///< empty if no facets were joined
  std::vector<double> triangles;  ///< one per patch: its number of triangles before refinement
  std::vector<double> faces;      ///< one per patch: the number of faces that is predicted for it
  double min_edge_length = 0;     ///< the floor with which these faces are predicted, in model units
};

/// Predicts the faces for some values of elements_per_circle. All other options stay. The prediction refines nothing
/// and cuts no boundary.
/// Output:  the predicted faces of the whole result for kPredictedElements. It is empty if no surface can be
///          remeshed as a whole. Most numbers are right within a factor of 2. Sizes that vary (proximity) count in the
///          planes only.
/// Holds:   the numbers grow with the number of elements.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
/// Source:  rules.md, Prediction of curved patches.
std::map<int, std::uint64_t> predict_by_elements_per_circle(const RecognisedFacets& facets,
                                                            const PresentPatches& present, const Options& options,
                                                            RunControl& control);

}  // namespace remesh
