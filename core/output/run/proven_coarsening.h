/// Makes a free-form surface coarser, with a proof.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/free_form/coarsen.h"
#include "core/free_form/free_form.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// A coarser surface that is proven to be near the surface from which it was made.
struct ProvenCoarsening {
  Coarsened surface;
  int surfaces = 0;  ///< how many surfaces were made until one could be proven
};

/// The faces around a surface of which a part becomes coarser. They stay.
struct FacesAround {
  std::span<const Vec3> positions;      ///< of all vertices
  std::span<const Triangle> faces;      ///< the triangles around the part
  std::span<const VertexId> of_vertex;  ///< the vertex among all for each vertex of the part
};

/// Why there is no coarser surface.
enum class CoarseningFault : std::uint8_t {
  kNone,
  kDistance,       ///< the last surface was farther from the input than the tolerance
  kTopology,       ///< the Euler number, the number of parts or the open edges had changed
  kIntersections,  ///< faces met that have no vertex or edge in common there
  kAngles,         ///< far more triangles would have had a small angle
  kAsManyFaces     ///< a surface within the tolerance needs no fewer triangles
};

/// The facts about a surface that must not change.
struct Topology {
  /// Errors: kCancelled, kTimeout - asked to stop through `control`.
  Topology(const TriangleMesh& mesh, RunControl& control);
  bool operator==(const Topology&) const = default;

  std::int64_t euler;
  std::uint64_t components;
  bool is_closed;
};

/// Returns the faces that meet others with which they have no vertex or edge in common there, ascending, and whether
/// all of them are known. Two faces that are still what they were in `input` do not count.
/// Input:  `places` are those of the coarser surface, in the unit of the positions around.
/// Errors: kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:   that of self_intersections.
std::pair<std::vector<FaceId>, bool> crossing_faces(const FreeForm& input, const Coarsened& made,
                                                    std::span<const Vec3> places, const FacesAround& around,
                                                    RunControl& control);

using IsWanted = std::function<bool(const Coarsened&)>;
/// Returns the faults that a surface has as it will be written.
using LastFaults = std::function<CoarseningFaults(const Coarsened&)>;

/// Makes a surface coarser until the result is proven to be within the tolerance, both ways, to have the topology of
/// the input, and not to meet itself or what is around. Where a proof fails, the coarser surface is refined. If that
/// does not help, another one is made, with a smaller share of the tolerance there; the last ones keep faces there.
/// There are at most kMaxCoarseSurfaces.
/// Input:   `goals.tolerance` is what has to be proven. Where `is_wanted` is false of the first surface, nothing is
///          proven. A surface that is proven counts if it has no `last_faults` either.
/// Output:  nothing if the last surface has failed; then `fault` tells how, and the surface should stay as it is.
/// Holds:   the result depends on places alone, and not on the number of threads.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:    that of CoarseSheet, CoarseningProof and self_intersections, for each surface.
std::optional<ProvenCoarsening> coarsen_with_proof(const FreeForm& input, const FacesAround& around,
                                                   const CoarseningGoals& goals, const IsWanted& is_wanted,
                                                   const LastFaults& last_faults, CoarseningFault& fault,
                                                   RunControl& control);

inline constexpr int kMaxCoarseSurfaces = 6;

}  // namespace remesh
