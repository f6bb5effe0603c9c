/// Remembers for which places of the input each triangle of a sheet answers.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/ids.h"
#include "core/base/vec.h"

namespace remesh {

/// The witnesses of a sheet: each vertex of the input and the centroid of each of its faces. Each of them belongs to
/// one triangle of the sheet, which has to be near. Those of a triangle form a list, and so do the vertices of an input
/// chain over which a chain edge leads.
struct SheetWitnesses {
  struct Witness {
    Vec3 place;
    FaceId face;         ///< the face of the input on which the witness lies
    std::uint32_t next;  ///< the next witness of the same triangle, or kNone
  };
  struct ChainWitness {
    Vec3 place;
    VertexId vertex;     ///< the input's vertex at this place
    float share;         ///< the share of the tolerance that counts here
    std::uint32_t next;  ///< the next one at the same chain edge, or kNone
  };

  std::vector<Witness> all;
  IdVector<FaceId, std::uint32_t> of_face;  ///< the first witness of each triangle of the sheet, or kNone
  std::vector<ChainWitness> on_chains;
  std::vector<std::uint32_t> of_chain;          ///< the first witness of each chain edge, or kNone
  IdVector<VertexId, std::uint32_t> of_vertex;  ///< the chain witness that a chain vertex is itself, or kNone
};

}  // namespace remesh
