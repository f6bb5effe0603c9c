#include "core/output/run/outcome.h"

namespace remesh {

std::string name(Outcome::End end) {
  switch (end) {
    case Outcome::End::kSurfaceReplaced: return "details_removed";
    case Outcome::End::kPatchesFailed: return "patches_failed";
    case Outcome::End::kWorkInVain: return "work_in_vain";
    case Outcome::End::kMinEdgeTooShort: return "floor_too_low";
    case Outcome::End::kGapsTooFine: return "gaps_too_fine";
    case Outcome::End::kTooManyMade: return "too_many_made";
    case Outcome::End::kFacetsCoarser: return "facets_coarser";
    case Outcome::End::kOffsetsImpossible: return "offsets_impossible";
    case Outcome::End::kOffsetsChanged: return "offsets_changed";
    case Outcome::End::kTooManyFaces: return "too_many_faces";
    case Outcome::End::kCheckFailed: return "check_failed";
    case Outcome::End::kVerified: return "verified";
  }
  return "";
}

}  // namespace remesh
