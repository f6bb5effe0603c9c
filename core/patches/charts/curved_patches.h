/// Joins the facets of curved surfaces into patches that are remeshed as a whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/surfaces/surface_map.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/recognition/recognised_surfaces.h"

namespace remesh {

/// The max distance of the result from a curved surface, and how coarse the result may be there.
struct CurvedLimits {
  /// The max distance between input and result of a patch, in model units. 0 means that its facets stay.
  double tolerance = 0;
  /// New edges lie within this distance of the surface, in model units.
  double max_height = 0;
  double max_turn = 0;  ///< the surface turns along an edge by at most this angle, in radians
  /// Max distance of boundaries that are cut anew from the input's boundaries and from the surface, in model units.
  double boundary_tolerance = 0;
  /// Max distance, along the surface, of new boundaries without a formula from the input's boundaries, in model units.
  double boundary_sideways = 0;

  /// Returns finer limits, for a patch that failed with the present ones. The tolerance stays.
  CurvedLimits tightened() const;
};

/// A rung is the treatment of a face of a curved surface after patches with the face have failed, or were too fine.
enum class CurvedRung : std::uint8_t {
  kJoined,     ///< the face is joined with others
  kTightened,  ///< the face is joined with others, within finer limits
  kCoarser,    ///< its facet stays a planar patch because that is coarser; nothing has failed
  kFacet       ///< its facet stays a planar patch
};

/// A patch that was joined from the facets of a curved surface.
struct CurvedPatch {
  SurfaceId surface;
  SurfaceMap map;  ///< one-to-one on the patch
  CurvedLimits limits;
  double area = 0;  ///< of its facets, in squared local units
};

/// The patches of a surface after the facets of curved surfaces were joined.
struct CurvedPatches {
  PatchSet patches;
  RecognisedSurfaces surfaces;          ///< the same surfaces as before, for these patches
  std::vector<CurvedPatch> curved;      ///< in the order of their patches
  IdVector<PatchId, std::uint32_t> at;  ///< index in `curved`, or kNone for a planar patch

  bool has_any() const { return !curved.empty(); }
  const CurvedPatch* of(PatchId p) const { return at.empty() || at[p] == kNone ? nullptr : &curved[at[p]]; }
};

/// Joins facets. Facets of one surface that meet at smooth edges become one patch, unless the patch would have no
/// one-to-one map into the plane: a closed tube becomes two halves, a ball two hemispheres, and a closed ring four
/// pieces. The borders between these run along edges of facets. A facet that is joined with no other facet stays
/// planar.
/// Input:   the facets, which are planar patches, and their recognised surfaces. `limits` has one entry per surface.
///          `rungs` has one entry per face; it may be empty if all faces are joined. The finest limits among a patch's
///          faces hold for all of it.
/// Output:  patches are numbered by their first faces. The planes of joined patches are only rough means.
/// Holds:   the result depends on geometry alone, apart from the numbers and from rounding.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
CurvedPatches join_curved_facets(const Surface& surface, const Adjacency& adjacency, const PatchSet& facets,
                                 const RecognisedSurfaces& recognised, double feature_angle_deg,
                                 std::span<const CurvedLimits> limits, const IdVector<FaceId, CurvedRung>& rungs,
                                 RunControl& control);

}  // namespace remesh
