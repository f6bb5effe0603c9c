/// Makes surfaces of no kind coarser after the surfaces of the facets have been recognised.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/output/run/replaced.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// Tells that a surface was made coarser.
struct Coarsening {
  std::size_t faces_before = 0;  ///< 0 if it was not
  double distance = 0;           ///< between the surface before and the one after, in model units
  bool is_done() const { return faces_before > 0; }
};

/// Holds a surface, with what was recognised of it.
struct FreeContext {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  const RecognisedSurfaces& recognised;
  double feature_angle_deg;  ///< edges that turn by more stay
};

/// Returns whether a surface is free as a whole, as scans, terrain and isosurfaces are: triangles without labels, of
/// which none belongs to a curved surface, some belong to none at all, and no plane is much larger than a facet.
/// Cost: O(n).
bool is_free_as_a_whole(const FreeContext& context, RunControl& control);

/// Makes a surface that is free as a whole coarser.
/// Input:   `tolerance` - how far the surfaces may be apart, in model units; no angle below `min_angle_deg` is made,
///          except where the surface's own angles are smaller. The surface does not intersect itself.
/// Output:  nothing, if no coarser surface was proven to be within the tolerance, both ways, to have the same topology,
///          and not to intersect itself. Otherwise the new surface, with the distance that is proven. Each of its faces
///          covers the input faces for which it answers.
/// Errors:  kCancelled, kTimeout - through `control`; kOutOfMemory - see MemoryBound.
/// Cost:    that of coarsen_with_proof.
std::optional<Replaced> coarser_surface(const FreeContext& context, double tolerance, double min_angle_deg,
                                        RunControl& control);

/// Tells that the surface was made coarser.
/// Input: `faces` - the number of its faces afterwards; `input_faces` - that of the input's faces.
Diagnostic coarsening(const Coarsening& done, std::size_t faces, std::size_t input_faces, double tolerance);

}  // namespace remesh
