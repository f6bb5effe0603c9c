/// Makes surfaces of no kind coarser after the surfaces of the facets have been recognised.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/diagnostic.h"
#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/mesh/surface.h"
#include "core/output/run/free_part.h"
#include "core/output/run/free_tolerance.h"
#include "core/output/run/proven_coarsening.h"
#include "core/output/run/replaced.h"
#include "core/patches/curved/curved_goals.h"

namespace remesh {

/// Tells that free faces were made coarser.
struct Coarsening {
  std::size_t faces_before = 0;            ///< the number of free triangles before; 0 if nothing was made
  std::size_t faces_after = 0;             ///< their number afterwards
  double tolerance = 0;                    ///< the one in force, in model units
  double distance = 0;                     ///< between the faces before and after, in model units
  bool is_whole = false;                   ///< whether all faces were free
  IdVector<FaceId, SurfaceId> surface_of;  ///< the recognised surface of each face afterwards
  IdVector<FaceId, std::uint8_t> is_new;   ///< whether the stage has made this face
  CoarseningFault fault =
      CoarseningFault::kNone;  ///< why nothing became coarser; kNone if something did, or nothing was tried
  bool is_done() const { return faces_before > 0; }
};

/// A surface after its free faces were made coarser.
struct Coarser {
  Replaced replaced;
  Coarsening done;
};

/// Returns the goals for free faces that the options make coarser; empty if they keep all facets.
/// Input: `curved` has the goals for curved surfaces that follow from the options.
std::optional<FreeGoals> free_goals_of(const CurvedGoals& curved, const Options& options);

/// Makes the free faces of a surface coarser. Planes beside them stay in their planes, and all other faces stay.
/// Input:   the goals, in model units; see tolerance_of.
/// Output:  nothing, if no coarser surface was proven to be within the tolerance, both ways, to have the same topology,
///          and to intersect nothing. Otherwise the new surface, with the distance that is proven. Each of its faces
///          covers the input faces for which it answers. `in_vain` gets the tolerance, and why nothing was made.
/// Errors:  kCancelled, kTimeout - through `control`; kOutOfMemory - see MemoryBound.
/// Cost:    that of coarsen_with_proof.
std::optional<Coarser> coarser_surface(const FreeContext& context, FreeGoals goals, Coarsening& in_vain,
                                       RunControl& control);

/// Tells why free faces stay as they are.
Diagnostic no_coarsening(const Coarsening& in_vain);

/// Tells that free faces were made coarser.
/// Input: the surface afterwards, and the options that decided it.
Diagnostic coarsening(const Coarsening& done, const Surface& surface, const Options& options);

}  // namespace remesh
