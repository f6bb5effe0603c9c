/// The state of one run on one surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mending/polygons/triangulated.h"
#include "core/mending/preparation.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/report/report.h"
#include "core/output/run/candidate.h"
#include "core/output/run/detail_stage.h"
#include "core/patches/curved/curved_stage.h"
#include "core/patches/meshing/partition.h"
#include "core/patches/planar/input_intersections.h"
#include "core/refinement/attempts/goal_refinement.h"
#include "core/refinement/goals/goals.h"

namespace remesh {

/// Holds what the stages of a run pass on to each other. The report is filled by all of them.
struct RunState {
  RunState(const PolygonMesh& input, const Options& options, RunControl& control)
      : input(input), options(options), control(control), watch(control) {
    report.options = options;
  }

  const PolygonMesh& input;
  const Options& options;
  RunControl& control;
  Stopwatch watch;
  Report report;
  Prepared prepared;
  std::optional<GoalRefinement> refiner;                  ///< belongs to the prepared surface
  std::optional<FoundIntersections> input_intersections;  ///< belongs to the prepared surface; empty until known
  DetailStage details;                                    ///< belongs to the prepared surface
  CurvedStage curves;                                     ///< belongs to the prepared surface
  Partition partition;
  Candidate candidate;

  const Surface& surface() const { return prepared.surface; }
  /// Returns the surface with the vertices between which boundaries were cut anew.
  const Surface& with_cuts() const { return curves.with_cuts(surface()); }
  const Adjacency& adjacency() { return prepared.adjacency(control); }
  PatchedSurface patched() { return {with_cuts(), adjacency(), partition.patches, report.plane_tolerance}; }
  const Goals* goals() const { return refiner->has_goals() ? &refiner->goals() : nullptr; }
  /// Returns the goals that the options ask for, if any. Curved patches are refined without any as well.
  const Goals* asked_goals() const { return options.refine ? goals() : nullptr; }
  /// Returns the mesh as read, or null if the surface has lost its details since.
  const PolygonMesh* read_input() const { return details.is_any_removed() ? nullptr : &input; }
  std::uint64_t triangles_of_input() const { return input.corners.size() - 2 * input.face_count(); }

  /// Finds the faces that intersect before anything is done to them. They are looked for between patches.
  void find_input_intersections(const Triangulated& faces);
  InputIntersections intersections() const { return intersecting_patches(*input_intersections, partition.patches); }
};

}  // namespace remesh
