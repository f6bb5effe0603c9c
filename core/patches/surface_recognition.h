/// Finds the surfaces from which the facets of a mesh were made.
#pragma once

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/boundary_loops.h"
#include "core/patches/essential_vertices.h"
#include "core/patches/patch_summary.h"
#include "core/patches/recognised_surfaces.h"

namespace remesh {

/// The patches of a surface, with the data of them that recognition reads.
struct Facets {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  const BoundaryLoops& loops;
  /// No vertex was forced to be essential (see Ladder). Forced vertices may lie on chords, which are inside of a curved
  /// surface.
  const EssentialVertices& essential;
  const std::vector<PatchSummary>& summaries;
};

/// The rules of recognition. They come from the input and from options, but never from a tolerance that a user allows
/// for the result.
struct RecognitionRules {
  double feature_angle_deg = 30;
  /// The largest distance of a facet's corner from its surface, in model units, that the proven rounding of the input's
  /// coordinates explains. It includes the errors of programs that compute less exactly than they print.
  double tolerance = 0;
  /// The distance that the printed digits explain alone, proven or not. Where the facets' chord height is much larger
  /// than this distance, corners may be off by as much.
  double printed = 0;
};

/// Recognises planes, cylinders, cones, spheres, tori and surfaces of revolution. All other facets are free.
/// Output:  every patch belongs to one surface. Equal surfaces are one.
/// Holds:   the result depends on geometry alone, not on the order of faces and vertices or on the number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n), about a microsecond a face.
RecognisedSurfaces recognise_surfaces(const Facets& facets, const RecognitionRules& rules, RunControl& control);

}  // namespace remesh
