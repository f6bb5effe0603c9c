#include "core/patch_types/patch_reason.h"

namespace remesh {

std::string_view reason_name(PatchReason reason) {
  switch (reason) {
    case PatchReason::kNone: return "";
    case PatchReason::kSelfIntersectingLoop: return "self_intersecting_loop";
    case PatchReason::kOverlappingFaces: return "overlapping_faces";
    case PatchReason::kNotPlanar: return "not_planar";
    case PatchReason::kBudget: return "budget";
    case PatchReason::kVerificationFailed: return "verification_failed";
  }
  return "";
}

}  // namespace remesh
