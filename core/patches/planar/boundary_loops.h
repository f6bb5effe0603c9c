/// Finds the boundary of each patch, as oriented loops.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"

namespace remesh {

/// Loops of half-edges with the patch on their left: seen along the patch's normal, outlines run counter-clockwise and
/// holes clockwise. A loop may touch itself in a vertex. A slit, which is a boundary edge with the same patch on both
/// sides, is in a loop twice.
struct BoundaryLoops {
  std::vector<std::uint32_t> half_edges;      ///< one loop after another
  std::vector<std::uint32_t> loop_begin{0};   ///< loop l has the half-edges [loop_begin[l], loop_begin[l + 1])
  std::vector<std::uint32_t> patch_begin{0};  ///< patch p has the loops [patch_begin[p], patch_begin[p + 1])
  std::vector<bool> is_boundary;              ///< one per half-edge: whether it is in some loop

  std::span<const std::uint32_t> loop(std::uint32_t l) const {
    return std::span(half_edges).subspan(loop_begin[l], loop_begin[l + 1] - loop_begin[l]);
  }
};

/// Finds the loops of all patches.
/// Output: the loops of each patch in the order of their first half-edges, each beginning with its first half-edge.
/// Holds:  every patch-boundary half-edge is in exactly one loop. Consecutive half-edges share a vertex around which
///         the patch's faces are connected, so loops that touch stay apart.
/// Cost:   O(n).
/// Source: J. Vermaak, The Surface Remeshing Module in ChiTech, 2018, section 4; rules.md, Open edges.
BoundaryLoops boundary_loops(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                             RunControl& control);

}  // namespace remesh
