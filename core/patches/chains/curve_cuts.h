/// Cuts the boundary curves of curved patches anew, once for all patches beside them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/chains/chain_cutting.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"

namespace remesh {

/// The boundaries of patches, some of which are curved.
struct PatchBoundaries {
  const Surface& surface;
  const Adjacency& adjacency;
  const PatchSet& patches;
  const BoundaryLoops& loops;
  const EssentialVertices& essential;
  const IdVector<VertexId, std::uint8_t>& forced;  ///< as for essential_vertices
  std::span<const VertexId> pinched;               ///< as for essential_vertices
};

/// The vertices of patch boundaries after the boundaries were cut anew.
struct CurveCuts {
  /// The new vertices between an essential vertex and the next one, in the direction of a half-edge.
  struct Start {
    std::uint32_t half_edge;
    std::uint32_t begin, end;  ///< in `lists`
  };

  EssentialVertices essential;  ///< the input's vertices that stay
  std::vector<Vec3> positions;  ///< the i-th new vertex has the number surface.vertex_count() + i; in model units
  std::vector<Start> starts;    ///< ascending by half-edge
  std::vector<VertexId> lists;  ///< one list after another
  /// The max distance by which boundaries have moved along the surface of each patch, in model units. It is 0 for
  /// planar patches. It is empty if no patch is curved.
  IdVector<PatchId, double> sideways;
  std::uint64_t cut_chains = 0;  ///< chains of which at least one part has new vertices
  std::uint64_t capped = 0;  ///< chains with more pieces than the tolerances require, because other boundaries are near

  /// Returns the new vertices between the essential vertex where half-edge h begins and the next essential vertex of
  /// its loop, in the loop's order.
  /// Input: a half-edge of a loop that begins at a vertex of `essential`.
  /// Cost:  O(log n).
  std::span<const VertexId> between(std::uint32_t h) const;
};

/// Cuts the chains that have a curved patch on some side. All other chains stay as they are.
/// Input:  one PatchSurface per patch. The shapes of curved patches are cylinders, cones, spheres and tori; chains
///         beside other shapes stay as they are.
/// Output: see cut_chain for the places of vertices. New vertices are ordered by the chains' positions.
/// Holds:  - corners stay. All patches beside a chain have the same vertices along it.
///         - no two chains become the same edge, and no loop becomes an edge or a point: where that would happen, a
///           vertex in the middle stays or is added.
///         - if no patch is curved, everything stays.
///         - the result depends on geometry alone, not on the order of faces and vertices or on the number of threads.
///           A scaling by a power of two scales it.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n), if few parts of a planar patch's boundary are near each other.
CurveCuts cut_curves(const PatchBoundaries& boundaries, const IdVector<PatchId, PatchSurface>& surfaces,
                     const CurveRules& rules, RunControl& control);

}  // namespace remesh
