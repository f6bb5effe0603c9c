/// Finds the chains of patch boundaries. A chain lies between two corners and has the same patches on its sides.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patch_types/patch_set.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"

namespace remesh {

/// A node of a chain: an essential vertex, and the edges of the input on both of its sides along the chain.
struct ChainNode {
  VertexId vertex;
  std::uint32_t before = kNone;  ///< a half-edge, in either direction, of the edge before the vertex
  std::uint32_t after = kNone;   ///< the same for the edge after the vertex
};

/// Chains of boundary edges. A chain is a largest run of boundary edges between two corners. A corner is a vertex that
/// does not have exactly two boundary edges, or one in which the surface touches itself. A ring is a closed boundary
/// without a corner.
struct BoundaryChains {
  std::vector<ChainNode> nodes;         ///< one chain after another
  std::vector<std::uint32_t> begin{0};  ///< chain c has the nodes [begin[c], begin[c + 1])

  std::size_t size() const { return begin.size() - 1; }
  std::span<const ChainNode> operator[](std::size_t c) const {
    return std::span(nodes).subspan(begin[c], begin[c + 1] - begin[c]);
  }
};

/// Returns whether a chain begins and ends in the same vertex.
inline bool is_closed(std::span<const ChainNode> chain) { return chain.front().vertex == chain.back().vertex; }

/// Returns all half-edges of the edge of a half-edge.
std::vector<std::uint32_t> half_edges_along(const Adjacency& adjacency, std::uint32_t half_edge);

/// Finds the chains that have one of the wanted patches on some side.
/// Input:  `is_wanted` has one entry per patch. `pinched` are the vertices that pinched_vertices finds.
/// Output: the chains, ordered by the positions of their first two nodes. The nodes of a chain are its essential
///         vertices. A chain begins at the smaller one of its ends. A closed chain runs towards the smaller neighbour
///         of its first node, and has this node again as its last one. If it is a ring, it begins at its smallest node.
///         The first node has an edge before it, and the last one has an edge after it, only if the chain is a ring.
/// Holds:  the result depends on geometry alone, not on the order of faces and vertices.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(n log n) in the edges of all boundaries.
BoundaryChains boundary_chains(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                               const BoundaryLoops& loops, const EssentialVertices& essential,
                               std::span<const VertexId> pinched, const IdVector<PatchId, std::uint8_t>& is_wanted,
                               RunControl& control);

}  // namespace remesh
