/// Enforces the chord rule: an edge inside a patch must not join the same two vertices as an edge of another patch or
/// as a boundary edge, because too many faces would then meet at that edge. If edges inside several patches join the
/// same two vertices, the one in the patch of lowest id stays. None of them stays if a boundary edge joins these
/// vertices.
/// Source: rules.md, Chords.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/base/run_control.h"
#include "core/patch_types/patch_mesh.h"
#include "core/patches/meshing/triangulated_patches.h"

namespace remesh {

/// An edge inside a patch that may not stay.
struct Chord {
  PatchId patch;
  std::uint32_t half_edge;
};

/// Says what became of the chords of a surface.
struct FlippedChords {
  bool are_any = false;       ///< some edges were flipped or constrained
  bool are_any_left = false;  ///< flips do not help everywhere
};

/// Finds the chords among the edges whose two ends are vertices below `vertex_end`. The other vertices lie inside a
/// single patch, so no other patch can share an edge at them.
/// Output: Sorted ascending by the edges' vertices, then by patch.
/// Cost:   O(n log n) in the number of the patches' edges.
std::vector<Chord> find_chords(const PatchMeshes& meshes, std::size_t vertex_end, RunControl& control);

/// Flips each chord whose quadrilateral is strictly convex, unless some patch uses the new edge already. The new
/// edge is constrained, so that later flips do not undo it.
FlippedChords flip_chords(PatchMeshes& meshes, std::size_t vertex_end, RunControl& control);

/// Puts a point into the middle of each chord and makes the triangles around it Delaunay. One point may remove several
/// chords. A chord without room for a point stays. If there are any chords, no edge is constrained for the sake of a
/// chord afterwards.
/// Input:  `before_change` is called with each patch before it changes, perhaps more than once.
/// Output: The patches, with their new vertices at the end. These have no ids yet. The new triangles are those at the
///         new vertices.
void split_chords(TriangulatedPatches& triangulated, std::size_t vertex_end,
                  const std::function<void(PatchId)>& before_change, RunControl& control);

}  // namespace remesh
