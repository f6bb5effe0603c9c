/// Makes a free-form surface coarser, with a proof.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/free_form/coarsen.h"
#include "core/free_form/free_form.h"

namespace remesh {

/// A coarser surface that is proven to be near the surface from which it was made.
struct ProvenCoarsening {
  Coarsened surface;
  double distance = 0;     ///< no point of either surface is farther from the other one than this, in local units
  int rounds = 0;          ///< how often the surface was made before it could be proven
  std::size_t stayed = 0;  ///< so many faces of the input stay, because nothing coarser could be proven there
};

/// The faces around a surface of which a part becomes coarser. They stay.
struct FacesAround {
  std::span<const Vec3> positions;      ///< of all vertices
  std::span<const Triangle> faces;      ///< the triangles around the part
  std::span<const VertexId> of_vertex;  ///< the vertex among all for each vertex of the part
};

/// Why no coarser surface could be proven in the last round.
enum class CoarseningFault : std::uint8_t {
  kNone,
  kDistance,      ///< the surfaces were farther apart than the tolerance
  kTopology,      ///< the Euler number, the number of parts or the open edges had changed
  kIntersections  ///< faces met that have no vertex or edge in common there
};

/// Returns the faces that meet others with which they have no vertex or edge in common there, ascending, and whether
/// all of them are known. Two faces that are still what they were in `input` do not count.
/// Input:  `places` are those of the coarser surface, in the unit of the positions around.
/// Errors: kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:   that of self_intersections.
std::pair<std::vector<FaceId>, bool> crossing_faces(const FreeForm& input, const Coarsened& made,
                                                    std::span<const Vec3> places, const FacesAround& around,
                                                    RunControl& control);

/// Makes a surface coarser until the result is proven to be within the tolerance, both ways, to have the topology of
/// the input, and not to meet itself or what is around. Where a proof fails, a smaller share of the tolerance counts in
/// the next round, at the faces that were at fault and around them; in the last rounds, faces stay there as they are.
/// There are at most kMaxCoarseningRounds.
/// Input:   `goals.tolerance` is what has to be proven.
/// Output:  nothing if the last round has failed; then `fault` tells how, and the surface should stay as it is.
/// Holds:   the result depends on places alone, and not on the number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:    that of coarsen, of distance_between and of self_intersections, for each round.
std::optional<ProvenCoarsening> coarsen_with_proof(const FreeForm& input, const FacesAround& around,
                                                   const CoarseningGoals& goals, CoarseningFault& fault,
                                                   RunControl& control);

inline constexpr int kMaxCoarseningRounds = 8;

}  // namespace remesh
