/// Checks that a mesh is still correct after an output format has rounded its coordinates.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/base/options.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/mesh.h"
#include "core/refinement/goals/unrefined_reason.h"
#include "core/verify/claim/claim.h"

namespace remesh {

/// The pipeline's claim about the coordinates that a file will have.
struct RoundedClaim {
  std::span<const Vec3> positions;  ///< the positions of the verified mesh
  std::span<const Vec3> stored;     ///< the numbers in the file, one point for each of `positions`
  Vec3 origin;                      ///< the point that a reader adds to each point of `stored`
  Storage storage = Storage::kFloat;
  std::span<const Triangle> faces;
  std::span<const PatchId> face_patch;
  std::span<const Vec3> normals;  ///< unit normal of each patch; any for a curved patch
  double allowed_move = 0;        ///< largest permitted move of a vertex, model units
  /// Intersections of the verified mesh, by patch; null if there are none.
  const InputIntersections* intersections = nullptr;
  const RefinementClaim* refinement = nullptr;  ///< the claim for the stored mesh; null if nothing was refined
  /// The faces of the verified mesh that miss the goals, ascending, and the reason of each. They are set together with
  /// `refinement`.
  std::span<const FaceId> unrefined_before = {};
  std::span<const UnrefinedReason> reasons_before = {};
  /// For each of these faces, true if it is larger than gaps or short edges allow. Rounding does not change that.
  std::span<const std::uint8_t> misses_sizes_before = {};
  /// For each patch, true if it is curved. Then its normal is not read. Empty means that all patches are planes.
  std::span<const std::uint8_t> is_curved = {};
};

/// The goals that a triangle must meet once its corners have moved by up to `move`. The bound on angles does not
/// change. The bounds on edges and areas grow by the amount by which such a move can enlarge a triangle that just meets
/// them, but by at most a millionth of the bound. For example, a cube with ten edges of 0.1 along each side meets a
/// bound of 0.1, although 0.1 is not a float.
Goals goals_after_rounding(const Goals& goals, double move);

enum class RoundedFault {
  kMalformed,         ///< the claim's arrays do not fit together
  kBeyondRange,       ///< a coordinate is beyond the largest number of the format
  kNotStorable,       ///< a coordinate is not a number of the format
  kMoved,             ///< a vertex is further from its place than permitted
  kMerged,            ///< two vertices are at the same place
  kTurnedOver,        ///< a triangle has lost its area, or points against its patch's normal
  kUnlisted,          ///< a face misses the goals, but is not in the claim's list of such faces
  kListedInVain,      ///< a face is in that list although it meets the goals
  kWrongReason,       ///< a face is in that list with a reason that does not apply to it
  kNewIntersections,  ///< faces intersect although their patches do not intersect in the verified mesh
};

struct RoundedVerdict {
  std::optional<RoundedFault> fault;  ///< the fault of the first test that failed; later tests are not made then
  std::uint64_t count = 0;            ///< number of elements with that fault
  double largest_move = 0;            ///< largest distance by which a vertex moved, as a reader gets it
  std::vector<double> patch_moves;    ///< the largest move among the vertices of each patch
  double volume_bound = 0;            ///< bound on the change of volume, if the mesh is closed
  bool has_intersections = false;  ///< false: no vertex has moved, so the intersections are those of the verified mesh
  std::vector<std::pair<FaceId, FaceId>> intersections;  ///< see Verdict::intersections
  bool are_all_intersections_known = true;
  double searched = 1;  ///< see Verdict::searched
};

/// Compares the stored mesh with the verified one.
/// Output:  a verdict without a fault if all of these are true:
///          - Every stored coordinate is a finite number of the format.
///          - No vertex moved by more than permitted, measured on the coordinates that a reader gets: origin + stored,
///            in doubles.
///          - No two vertices are at the same place.
///          - Every triangle has an area and points along its patch's normal, except triangles that did not before. A
///            triangle of a curved patch does not point against its direction before rounding.
///          - The faces that miss the goals (see goals_after_rounding) are in `refinement->unrefined`. The other faces
///            in that list are in `unrefined_before` too, because they are larger than gaps or short edges allow. A
///            face with the reason kOutputRounding is not in `unrefined_before`. Every other reason is the one that the
///            face has there.
///          - Faces intersect (patch_intersections.h) only where their patches do in the verified mesh.
/// Holds:   the verdict does not depend on the number of threads. If no vertex moved, only the first two tests are
///          made.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n); for the intersections as patch_intersections.
RoundedVerdict check_rounded(const RoundedClaim& claim, RunControl& control);

}  // namespace remesh
