/// The report of a run, as plain values. Field names are those of the contract's JSON report.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/stopwatch.h"
#include "core/base/vec.h"
#include "core/io/common/writing.h"
#include "core/mesh/statistics.h"
#include "core/output/report/solid_counts.h"
#include "core/output/report/volume_obstacle.h"
#include "core/patches/planar/patch_summary.h"
#include "core/patches/recognition/recognised_surfaces.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/verify/claim/verdict.h"

namespace remesh {

/// A report tells what a run found and did.
/// This class is larger than the bound because it has the members of the contract's report, in their order.
struct Report {
  Options options;             ///< the options that were used
  double plane_tolerance = 0;  ///< the tolerance that was used, in model units
  bool plane_tolerance_is_automatic = true;
  /// The tolerance before details were removed, in model units. It is smaller if their removal has bent planes.
  double first_plane_tolerance = 0;
  /// The length below which refinement made no edge, in model units; 0: there was no such floor.
  double min_edge_length = 0;
  /// The largest edge that was chosen for a target, in model units. 0: there is no target. Infinity: the other options
  /// need as many faces.
  double largest_edge_for_target = 0;
  /// The step to which coordinates are proven to be rounded; without proof, the last place of the largest coordinate.
  double rounding_step = 0;
  /// Bound on the change of volume. It is the verdict's, or for an analysis that of PatchSummaries.
  double volume_bound = 0;
  MeshStatistics input;
  std::string input_unit;     ///< the unit of the coordinates of the input, if its format tells it
  std::string input_up_axis;  ///< the axis that points upwards, if its format tells it
  MeshStatistics output;
  /// The largest distance by which the output format moved a vertex, in model units; 0 if it holds all coordinates.
  double output_rounding = 0;
  /// The point to which the written coordinates are relative; empty if they are the model's own.
  std::optional<Vec3> output_origin;
  std::vector<PatchSummary> patches;
  RecognisedSurfaces surfaces;  ///< those of the input; `of_patch` has one entry per item of `patches`
  /// These numbers tell what was cut and dropped. They are empty unless a repair asked for that and some faces met.
  std::optional<SolidCounts> solids;
  std::vector<Diagnostic> diagnostics;
  /// The names of labels that the output format has in another form, because mesh programs would not read them.
  std::vector<RenamedLabel> renamed_labels;
  std::vector<std::string> filling_lines;  ///< of Gmsh's language, with which it fills the written file, if it can
  std::vector<VolumeObstacle> volume_obstacles;  ///< those of the result; for an analysis, those of the input as mended
  std::uint64_t predicted_faces = 0;  ///< for an analysis: the number of faces that a remeshing is expected to make
  /// The number of faces that is predicted for other values of elements_per_circle. It is empty if no surface is
  /// curved, and for a remeshing.
  std::map<int, std::uint64_t> predicted_faces_by_elements_per_circle;
  /// The smallest distance of a facet from another one that is not its neighbour, in model units; see gap_search.h. It
  /// is empty where there is no gap, and where the search for it was cut short.
  std::optional<double> smallest_gap;
  std::vector<Unrefined> unrefined;  ///< one per reason that occurs, in the order of the enumeration
  std::uint32_t refinement_rounds = 0;
  Verdict verified;
  std::optional<DistanceBound> distance_bound;  ///< proven for the whole result; empty for an analysis
  std::vector<StageTime> timing_ms;
};

}  // namespace remesh
