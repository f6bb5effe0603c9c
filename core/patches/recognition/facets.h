/// The facets of a mesh, and the rules by which their surfaces are recognised.
#pragma once

#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"
#include "core/patches/planar/patch_summary.h"

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

}  // namespace remesh
