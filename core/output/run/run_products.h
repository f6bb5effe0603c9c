/// The products of a run, in the order in which its steps make them.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/stopwatch.h"
#include "core/mending/preparation.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/output/report/report.h"
#include "core/output/run/candidate.h"
#include "core/output/run/detail_stage.h"
#include "core/output/run/free_stage.h"
#include "core/output/run/replaced.h"
#include "core/output/run/solid_stage.h"
#include "core/patches/curved/joined_facets.h"
#include "core/patches/meshing/partition.h"
#include "core/patches/planar/input_intersections.h"
#include "core/patches/recognition/recognised_surfaces.h"
#include "core/refinement/attempts/refinement_choices.h"
#include "core/refinement/attempts/surface_refinement.h"
#include "core/refinement/goals/goals.h"

namespace remesh {

/// Holds the products of the steps of a run. They belong to one owner at a time: first to the attempts, then to the
/// report.
/// This class is larger than the bound because it has a member for each step.
struct RunProducts {
  RunProducts(const PolygonMesh& input, const Options& options, RunControl& control)
      : input(input), options(options), control(control), watch(control) {
    report.options = options;
  }

  const PolygonMesh& input;
  const Options& options;
  RunControl& control;
  Stopwatch watch;
  Report report;  ///< as far as it is known
  Prepared prepared;
  SpentOnStages spent;  ///< by the stages that have replaced the prepared surface
  DetailLimits detail_limits;
  ArrangedFaces arranged;
  RemovedDetails removed;
  Coarsening coarsening;
  std::optional<FoundIntersections> input_intersections;  ///< empty until known
  Partition partition;
  RecognisedSurfaces recognised;  ///< the surfaces of the facets
  JoinedFacets joined;
  std::optional<SurfaceRefinement> refinement;
  RefinementChoices choices{MinEdgeSearch(Goals{})};  ///< those of the last attempt
  std::uint64_t size_steps = 0;                       ///< of all searches for gaps
  Candidate candidate;

  const Surface& surface() const { return prepared.surface(); }
  /// Returns the surface with the vertices between which boundaries were cut anew.
  const Surface& with_cuts() const { return joined.with_cuts ? *joined.with_cuts : surface(); }
  const Adjacency& adjacency() { return prepared.adjacency(control); }
  /// Returns the patches before facets were joined.
  const PatchSet& facets() const { return joined.curved() != nullptr ? joined.facets : partition.patches; }
  /// Returns what refinement gets. The result refers to `crossing`.
  PatchedSurface patched(const InputIntersections& crossing) {
    return {with_cuts(), adjacency(), partition.patches, report.plane_tolerance, crossing.patches};
  }
  Goals goals() const { return refinement->goals(choices); }
  bool has_goals() const { return refinement->has_goals(choices); }
  /// Returns whether the options ask for goals. Curved patches are refined without any as well.
  bool has_asked_goals() const { return options.refine && has_goals(); }
  /// Returns the mesh as read, or null if a stage has replaced the surface that was made of it.
  const PolygonMesh* read_input() const { return spent.stages > 0 ? nullptr : &input; }
  std::uint64_t triangles_of_input() const { return input.corners.size() - 2 * input.face_count(); }
  InputIntersections intersections() const { return intersecting_patches(*input_intersections, partition.patches); }
  /// Finds the faces that intersect before anything is done to them, if they are not known. They are looked for between
  /// patches.
  void find_input_intersections(const Triangulated& faces);
};

}  // namespace remesh
