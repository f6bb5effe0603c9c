/// What a run tells about itself, as plain values. Field names are those of the contract's JSON report.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/options.h"
#include "core/base/stopwatch.h"
#include "core/base/vec.h"
#include "core/mesh/statistics.h"
#include "core/output/volume_obstacle.h"
#include "core/patches/patch_summary.h"
#include "core/refinement/unrefined_reason.h"
#include "core/verify/verdict.h"

namespace remesh {

struct Report {
  Options options;             ///< as used
  double plane_tolerance = 0;  ///< as used, model units
  bool plane_tolerance_is_automatic = true;
  double rounding_step = 0;  ///< to which coordinates are proven to be rounded; else the last place of the largest one
  double volume_bound = 0;   ///< of the change of volume: the verdict's; of an analysis, PatchSummaries'
  MeshStatistics input;
  MeshStatistics output;
  /// The largest distance by which the output format moved a vertex, model units; 0 if it holds all of them.
  double output_rounding = 0;
  /// The point that the written coordinates are relative to; empty if they are the model's own.
  std::optional<Vec3> output_origin;
  std::vector<PatchSummary> patches;
  std::vector<Diagnostic> diagnostics;
  std::vector<VolumeObstacle> volume_obstacles;  ///< of the result; of an analysis: of the input as mended
  std::uint64_t predicted_faces = 0;
  std::optional<double> smallest_gap;  ///< to the nearest facet that is not a neighbour, model units; see gap_search.h
  std::vector<Unrefined> unrefined;    ///< by reason, in the order of the enumeration; only those that occur
  std::uint32_t refinement_rounds = 0;
  Verdict verified;
  std::vector<StageTime> timing_ms;
};

}  // namespace remesh
