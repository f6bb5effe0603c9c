/// Is a mesh still the verified one where an output format has rounded its coordinates?
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
#include "core/refinement/unrefined_reason.h"
#include "core/verify/verify.h"

namespace remesh {

/// What the pipeline says about the coordinates that a file will have.
struct StoredClaim {
  std::span<const Vec3> positions;  ///< of the verified mesh
  std::span<const Vec3> stored;     ///< the numbers in the file, one point for each of `positions`
  Vec3 origin;                      ///< a reader adds it to `stored`
  Storage storage = Storage::kFloat;
  std::span<const Triangle> faces;
  std::span<const PatchId> face_patch;
  std::span<const Vec3> normals;                      ///< unit, of each patch
  double allowed_move = 0;                            ///< of a vertex, model units
  const InputIntersections* intersections = nullptr;  ///< of the verified mesh, by patch; null: none
  const RefinementClaim* refinement = nullptr;        ///< of the stored mesh; null: nothing was refined
  /// The faces that were listed before, ascending, and why; with `refinement`.
  std::span<const FaceId> unrefined_before = {};
  std::span<const UnrefinedReason> reasons_before = {};
  /// Whether each of them is larger than gaps or short edges ask for. Rounding does not change that.
  std::span<const std::uint8_t> misses_sizes_before = {};
};

/// The goals that a triangle must meet once its corners have moved by up to `move`. Edges and areas may be larger by
/// what such a move can make of those that are as large as allowed, so that a rounded edge length is no fault of a cube
/// with ten edges to a side. Angles may not change.
Goals goals_after_rounding(const Goals& goals, double move);

enum class StoredFault {
  kMalformed,         ///< the claim's arrays do not fit together
  kBeyondRange,       ///< a coordinate is beyond the largest number of the format
  kNotStorable,       ///< a coordinate is no number of the format
  kMoved,             ///< a vertex is further from its place than allowed
  kMerged,            ///< two vertices are one place
  kTurnedOver,        ///< a triangle has lost its area, or looks away from its patch's normal
  kUnlisted,          ///< a face misses the goals and is not listed
  kListedInVain,      ///< a face is listed, and meets the goals
  kWrongReason,       ///< a face is listed for a reason that it has not
  kNewIntersections,  ///< faces intersect of patches that do not in the verified mesh
};

struct StoredVerdict {
  std::optional<StoredFault> fault;  ///< of the first test that failed; the tests behind it were not made
  std::uint64_t count = 0;           ///< elements with that fault
  double largest_move = 0;           ///< of a vertex, as a reader gets it
  std::vector<double> patch_moves;   ///< the same for the vertices of each patch
  double volume_bound = 0;           ///< of the change of volume, where the mesh is closed
  bool has_intersections = false;    ///< false: no vertex was moved, so they are those of the verified mesh
  std::vector<std::pair<FaceId, FaceId>> intersections;  ///< as Verdict::intersections
  bool are_all_intersections_known = true;
};

/// Holds the stored mesh against the verified one.
/// Output:  a verdict without fault if
///           - every stored coordinate is a finite number of the format;
///           - no vertex moved by more than allowed, measured on what a reader gets: origin + stored, in doubles;
///           - no two vertices are one place;
///           - every triangle has an area and looks along its patch's normal, but for those that did not before;
///           - the faces that miss the goals (see goals_after_rounding) are listed, and besides them only those that
///             were listed before because they are larger than gaps or short edges ask for; what is listed for
///             kOutputRounding met the goals before and was not listed, and every other reason is the one that the
///             face had before;
///           - faces intersect (geometry/patch_intersections.h) only where their patches do in the verified mesh.
/// Holds:   the same verdict for any number of threads. Where no vertex moved nothing but the first two is tested.
/// Errors:  kCancelled, kTimeout - through `control`.
/// Cost:    O(n log n); for the intersections as patch_intersections.
StoredVerdict check_stored_form(const StoredClaim& claim, RunControl& control);

}  // namespace remesh
