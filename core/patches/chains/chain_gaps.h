/// Measures how near a chain is to other parts of a planar patch's boundary.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/geometry/trees/box_tree.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/surface.h"
#include "core/patches/chains/boundary_chains.h"
#include "core/patches/planar/boundary_loops.h"
#include "core/patches/planar/essential_vertices.h"

namespace remesh {

/// A search for the boundaries of planar patches. If a chain moves too far in the plane of a patch, it crosses another
/// boundary of that patch, for example when both borders of a thin ring are cut anew.
class ChainGaps {
 public:
  /// Input:  `is_searched` has one entry per patch. It is set for the planar patches that will be asked for. The
  ///         surface and the chains outlive this object.
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  /// Cost:   O(n log n) in the boundary edges of these patches.
  ChainGaps(const Surface& surface, const Adjacency& adjacency, const BoundaryLoops& loops,
            const EssentialVertices& essential, const BoundaryChains& chains,
            const IdVector<PatchId, std::uint8_t>& is_searched, RunControl& control);

  /// Returns how far a chain may move at a place: a quarter of the distance to the nearest edge of another chain of
  /// the patch. If that edge has an end in common with the chain, it is half of the distance, or three quarters if the
  /// edge is straight and stays as it is. Edges that continue from an end of the chain at an obtuse angle do not count.
  /// Input:  a place on the chain, in model units. The patch was among `is_searched`.
  /// Output: at most `limit`, which is in model units as well.
  /// Cost:   O(log n), if few edges are nearer than four times the limit. May be called by many threads at once.
  double room(std::uint32_t chain, PatchId patch, const Vec3& place, double limit) const;

 private:
  struct Piece {
    VertexId from, to;
  };
  /// The chain to which all pieces of a box belong.
  struct ChainTag {
    static constexpr std::uint32_t kMixed = kNone - 1;

    std::uint32_t chain = kNone;  ///< kNone if the pieces belong to no known chain, kMixed if they belong to several

    void join(ChainTag other) {
      if (chain != other.chain) chain = kMixed;
    }
  };
  struct PatchPieces {
    std::vector<Piece> pieces;
    BoxTree<ChainTag> tree;
  };

  std::uint32_t chain_of(const Piece& piece) const;
  bool is_of_chain(const Piece& piece, std::uint32_t chain) const;
  bool is_out_of_the_way(std::uint32_t chain, std::uint32_t other) const;
  bool goes_on_from(std::uint32_t chain, std::uint32_t other) const;
  double part_of_distance(std::uint32_t chain, const Piece& piece, const Vec3& nearest) const;

  const Surface& surface_;
  const BoundaryChains& chains_;
  IdVector<VertexId, std::uint32_t> chain_of_;  ///< the chain that a vertex is inside of, or kNone
  IdVector<PatchId, std::uint32_t> of_patch_;   ///< index into `searched_`, or kNone
  std::vector<PatchPieces> searched_;
};

}  // namespace remesh
