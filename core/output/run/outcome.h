/// The outcome of an attempt at a surface. All places are input faces, so that nobody needs geometry to learn from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/patches/curved/curved_choices.h"
#include "core/patches/planar/face_rungs.h"
#include "core/refinement/attempts/refinement_choices.h"

namespace remesh {

/// Tells how an attempt has ended, and what it has shown.
/// This class is larger than the bound because each end of an attempt comes with its own facts.
struct Outcome {
  /// How an attempt ends, in the order of its steps.
  enum class End : std::uint8_t {
    kSurfaceReplaced,    ///< details were removed, or the surface was made coarser, so there is another one
    kNothingCut,         ///< no faces were cut, and what has waited for that begins without the ladder
    kPatchesFailed,      ///< patches could not be triangulated
    kWorkInVain,         ///< earlier results that failed the check took too much work, so none was tried
    kMinEdgeTooShort,    ///< there would surely be more faces than are in proportion
    kGapsTooFine,        ///< gaps ask for far more faces than are allowed
    kTooManyMade,        ///< refinement made far too many faces, or would make them
    kFacetsCoarser,      ///< facets of curved surfaces are coarser than joined patches, or finer
    kOffsetsImpossible,  ///< curved surfaces have too few vertices that may move to keep their volumes
    kOffsetsChanged,     ///< curved surfaces have to be moved by other offsets
    kTooManyFaces,       ///< the result has too many faces, or another floor may serve as well
    kCheckFailed,        ///< the result has not passed verification
    kVerified            ///< the result has passed verification
  };
  End end = End::kVerified;

  std::size_t input_faces = 0;          ///< the number of all input faces
  bool is_arranged = false;             ///< faces that intersect were cut
  bool is_arranging_in_vain = false;    ///< no faces were cut, or no cut could be proven
  bool are_details_done = false;        ///< details were looked for in vain
  bool is_coarsened = false;            ///< the surface was made coarser
  bool is_coarsening_in_vain = false;   ///< no coarser surface could be proven
  bool are_elements_automatic = false;  ///< nobody has asked for curved patches; they are the default
  bool are_any_crossing = false;        ///< patches cross or touch each other in the input
  bool are_any_moved = false;           ///< curved surfaces are moved outwards
  bool was_any_joined = false;          ///< mending has joined or divided faces, which may be at fault
  RefinementFacts facts;

  double coarsest = 0;                  ///< the size that gaps should not go below, in model units
  CoarserFaces compared;                ///< what the comparison of facets with joined patches has shown
  IdVector<SurfaceId, double> offsets;  ///< better ones, in local units
  std::optional<std::uint64_t> faces;   ///< those of the result, once there is one
  bool are_angles_worse = false;        ///< than before refinement, and the floor has left them
  std::vector<FailedFaces> failed;      ///< the patches that failed
  /// Which of the failed patches had to stay as they were before refinement.
  std::vector<std::uint8_t> was_frozen;
  bool is_whole_wrong = false;      ///< no single patch is at fault
  std::vector<CurvedFault> faults;  ///< the curved patches that may be at fault
  std::string reason;               ///< the first failure of the check, for people

  /// The work that the attempt took.
  std::uint64_t triangles = 0, search_steps = 0, size_steps = 0;
  std::optional<std::uint64_t> max_in_vain;  ///< see Effort
};

}  // namespace remesh
