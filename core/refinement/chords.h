/// The chord rule: an edge inside one patch must not be an edge of another patch too, nor a boundary edge, or the
/// surface would meet itself there. Of equal edges the one in the patch of lowest id stays (none, if one is a
/// boundary).
/// Source:  rules.md, Chords.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"

namespace remesh {

/// An edge inside a patch that may not stay.
struct Chord {
  PatchId patch;
  std::uint32_t half_edge;
};

/// The chords among the edges whose two ends are vertices below `vertex_end`: what lies inside one patch is shared by
/// no other.
/// Output:  ascending by their vertices, then by patch.
/// Cost:    O(n log n) in the patches' edges.
std::vector<Chord> find_chords(const std::vector<PatchMesh>& meshes, std::size_t vertex_end, RunControl& control);

/// Flips chords away, where the quadrilateral is strictly convex and the new edge is free; it is held then.
/// Output:  whether none is left.
bool flip_chords(std::vector<PatchMesh>& meshes, std::size_t vertex_end, RunControl& control);

/// Puts a point into the middle of each chord, and makes what is around it Delaunay; one point may end several chords.
/// What has no room for a point stays. Nothing is held any more then.
/// Output:  the patches with more vertices at the end, which have no ids yet; the new triangles are those at them.
void split_chords(std::vector<PatchMesh>& meshes, std::size_t vertex_end, RunControl& control);

}  // namespace remesh
