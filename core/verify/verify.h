/// The independent check of the promises. It shares no decision with the stages: it has its own edges and its own exact
/// arithmetic, and takes from the pipeline only what is claimed. Three tools are common: the search for intersections
/// (patch_intersections); boxes and distances (BoxTree, nearest_on_triangle), for faces that lie folded over their
/// patch and for gaps; and, for gaps, the triangles of polygons (split_polygon).
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/frame.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"
#include "core/refinement/goals.h"
#include "core/refinement/unrefined_reason.h"
#include "core/verify/verdict.h"

namespace remesh {

/// What refinement says it has reached.
struct RefinementClaim {
  Goals goals;
  /// Output faces that do not meet the goals (an angle below the bound, an edge or area above it, or above what gaps or
  /// short edges ask for there), ascending, and why.
  std::span<const FaceId> unrefined;
  std::span<const UnrefinedReason> reasons;  ///< one per entry of `unrefined`
  /// Of each patch, whether refinement had to leave it and its boundary as they were; empty: none.
  std::span<const std::uint8_t> frozen = {};
};

/// Which patches intersect in the input: pairs of them, sorted, the smaller one first; (p, p) for within a patch.
struct InputIntersections {
  std::vector<std::pair<PatchId, PatchId>> patches;
  bool is_complete = true;  ///< false: there are so many that these are not all
};

/// What the pipeline says it has done.
struct Claim {
  const Surface& surface;                  ///< what was remeshed
  std::span<const PatchId> surface_patch;  ///< of each face of `surface`
  const IdVector<PatchId, Frame>& frames;
  std::span<const Vec3> positions;                    ///< output vertices
  std::span<const Triangle> faces;                    ///< output faces
  std::span<const PatchId> face_patch;                ///< patch of each output face
  std::span<const Vec2> corner_uv;                    ///< stored plane coordinates, 3 per output face
  double plane_tolerance = 0;                         ///< model units
  bool has_new_vertices = false;                      ///< refinement's, or where the chord rule asked for some
  const RefinementClaim* refinement = nullptr;        ///< null: nothing was refined
  const InputIntersections* intersections = nullptr;  ///< null: none
  /// The corners of `surface` by (smaller, larger vertex, corner) of the edge that begins there. Empty, or wrong: the
  /// checker sorts them itself.
  std::span<const std::uint32_t> surface_edge_order = {};
  /// The mesh as read, of which `surface` was made by welding within `weld_tolerance` and by mending; null: not known.
  const PolygonMesh* input = nullptr;
  double weld_tolerance = 0;  ///< model units
};

/// Tests the promises 1 to 3 of README.md.
/// Output:  a verdict; `failed_patches` names every patch on which a test failed.
///  surface:    every output vertex is a surface vertex bit for bit - or, where such are claimed, a new one: inside a
///              patch and as near to its plane as its input is, or on an edge between vertices that stay, to rounding;
///              input and output lie within plane_tolerance of each other, both ways, patch by patch; every patch keeps
///              its boundary loops (each output loop is the input loop less vertices within tolerance of the chord that
///              replaces them); Euler number, closedness, area and volume are kept within what the deviations explain;
///              the faces that came of a polygon of the input cover it once, where it does not cross itself;
///              `volume_bound` is that for the volume: of each patch its area, input's or output's, with what lies
///              between the loops, times the largest difference of their heights; and rounding.
///  conforming: every output edge has the faces, and the directions, that the input's edges under it have; no zero-area
///              or inverted triangle but for the input's own, no repeated face, no new non-manifold edge, no
///              T-junction; faces intersect (geometry/patch_intersections.h) only where their patches do in the input,
///              which is not asked if that has too many intersections to list, and only of some if the output has:
///              `are_all_intersections_known` tells.
///  delaunay:   the stored plane coordinates are the projections of the vertices; every edge inside a patch is locally
///              Delaunay in them by exact arithmetic - or the edge that would replace it exists elsewhere in the output
///              (the chord rule).
///  quality:    (with refinement) the faces that do not meet the goals, measured on the output's doubles, are exactly
///              the listed ones, and what is listed for an input angle is at one: kInputAngle - the smallest angle is
///              at a surface vertex, between two boundary edges of the patch, and the other two meet the bound;
///              kAcrossInputAngle - the ends of the shortest edge lie on two boundary chains (of the patch, between
///              vertices that stay) that meet in a vertex, equally far from there to 1e-9, and nearer to each other
///              than to it (an angle under 60 degrees); kBoundaryLocked - boundaries are not to be split, or the patch
///              or one beside it is frozen. What gaps and short edges ask for is measured anew
///              (verify/varying_sizes.h). Edges that refinement made are at least min_edge_length long.
/// Holds:   the same verdict for any number of threads.
/// Cost:    O(n log n).
Verdict verify(const Claim& claim, RunControl& control);

}  // namespace remesh
