/// Proves that an arrangement is the surface of which it was made, and that a union keeps the right part of it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"
#include "core/solids/arrangement.h"

namespace remesh {

/// The claim that an arrangement is made of the pieces of triangles. All is in model units.
struct ArrangementClaim {
  std::span<const Vec3> positions_before;
  std::span<const Triangle> faces_before;
  const Arrangement& after;
  double distance;  ///< the distance within which features were joined
};

/// The result of a proof: a bound, or why there is none.
struct ArrangementProof {
  std::optional<double> distance;  ///< no point of either surface is further than this from the other one
  std::string failure;             ///< empty if there is a distance
};

/// Tests an arrangement by the triangles that each of its faces covers. It shares no code with the arrangement but the
/// search for intersections.
/// Output: the max distance of any point of either surface from the other one. The arrangement is proven if all of the
///         following holds:
/// - Vertices that stay have the coordinates that they had, and each of them is there once.
/// - The pieces of each triangle cover it once. After edges in opposite directions have cancelled, the remaining ones
///   run along the sides of the triangle, once from end to end. The pieces' areas, as seen along the triangle's normal,
///   add up to its area. Each of them faces as the triangle does, unless it is as thin as a contact is wide, or belongs
///   to the pairs that are told to intersect.
/// - No corner of a piece is further from the triangle than the arrangement says.
/// - A triangle without pieces is hardly higher than a contact is wide. So is each dropped flap, which covers as much
///   from one side as from the other. Where pieces of a triangle are missing, all of its points are nearer to the faces
///   that stay than some contacts are wide, see verification::distance_from.
/// - No two faces have the same corners, and none meet but in common corners and edges, except for the pairs that are
///   told.
/// Errors: kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:   O(n log n), and that of the search for intersections.
ArrangementProof prove_arrangement(const ArrangementClaim& claim, RunControl& control);

/// The claim that some faces of an arrangement bound the union of solids.
struct UnionClaim {
  std::span<const Vec3> positions_before;
  std::span<const Triangle> faces_before;
  /// By triangle before: by how much it changes the winding number from its front to its back; 0 for open shells.
  std::span<const std::int32_t> weights;
  const Arrangement& after;                 ///< before faces were dropped
  std::span<const std::uint8_t> stays;      ///< by face of the arrangement
  std::span<const std::uint8_t> is_turned;  ///< by face of the arrangement
  double distance;                          ///< as in ArrangementClaim
};

/// Tests a union by solid angles: for one face of each sheet of faces that hang together over edges of two faces, the
/// winding number of the triangles before is computed on both of its sides, where no two sheets meet. Solid is where it
/// is 1 or more. All faces of a sheet have to stay, be turned or go as that says. Besides, faces that stay must be
/// closed by themselves, if all triangles before were.
/// Output: why the union is not proven; empty if it is. Sheets that are nowhere wider than some contacts are tested for
///         being closed only.
/// Errors: kCancelled, kTimeout - asked to stop through `control`; kOutOfMemory - see MemoryBound.
/// Cost:   O(n log n) for n triangles and sheets.
std::string find_fault_of_union(const UnionClaim& claim, RunControl& control);

}  // namespace remesh
