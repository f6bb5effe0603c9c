/// Finds the offsets of curved surfaces at which the triangles keep the volume, and moves vertices by these offsets.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/charts/curved_patches.h"
#include "core/patches/curved/offset_moves.h"
#include "core/patches/curved/volume_offsets.h"
#include "core/patches/meshing/triangulated_patches.h"

namespace remesh {

/// The triangles of a surface whose curved patches were moved outwards by estimated offsets.
struct FitInput {
  const Surface& surface;  ///< with the vertices of cuts, at the places to which they were moved
  const PatchSet& patches;
  const CurvedPatches& curved;
  const VolumeOffsets& fit;
  /// The triangles meet goals of refinement. So boundaries stay where they are, if there are enough vertices inside of
  /// a curved surface.
  bool is_refined = false;
};

struct FittedVolumes {
  IdVector<SurfaceId, double> offsets;  ///< the offsets at which the goals are met
  IdVector<SurfaceId, double> better;   ///< the estimates that another attempt should begin with
  IdVector<SurfaceId, double> outside;  ///< the largest distances by which vertices are moved out of surfaces
  std::vector<SurfaceId> impossible;    ///< surfaces that have too few vertices which may move
  /// The offsets differ from the estimates by no more than some per cent, so that triangles keep their shapes.
  bool is_near = true;
  OffsetMoves moves;  ///< the moves of all vertices of curved patches, from their present places
};

/// Solves for the offsets by Newton's method, for all surfaces at once: between the triangles of each surface and the
/// true surface, the volume inside must equal the volume outside. Each triangle's volume is a polynomial in the
/// offsets.
/// Output:  nothing is moved yet.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(triangles of curved patches) for each of a few steps; O(n log n) once.
/// Source:  rules.md, Volume of circles.
FittedVolumes fit_volumes(const FitInput& input, const TriangulatedPatches& triangulated,
                          const std::vector<Vec3>& new_positions, RunControl& control);

/// The vertices that move_to_fit has moved.
struct FittedVertices {
  std::vector<std::pair<VertexId, Vec3>> places;  ///< the new places of the surface's own vertices, ascending
  std::vector<std::uint8_t> is_moved;             ///< one per vertex
};

/// Moves all vertices by the difference between the offsets that were found and the estimates. Planar patches with
/// moved vertices are made Delaunay again.
/// Output:  `new_positions`, and which vertices were moved.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
FittedVertices move_to_fit(const FitInput& input, const FittedVolumes& fitted, TriangulatedPatches& triangulated,
                           std::vector<Vec3>& new_positions, RunControl& control);

}  // namespace remesh
