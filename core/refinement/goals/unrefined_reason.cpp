#include "core/refinement/goals/unrefined_reason.h"

namespace remesh {

std::string_view unrefined_name(UnrefinedReason reason) {
  switch (reason) {
    case UnrefinedReason::kInputAngle: return "input_angle";
    case UnrefinedReason::kAcrossInputAngle: return "across_input_angle";
    case UnrefinedReason::kSizeFloor: return "size_floor";
    case UnrefinedReason::kMinEdgeLength: return "min_edge_length";
    case UnrefinedReason::kBudget: return "budget";
    case UnrefinedReason::kBoundaryLocked: return "boundary_locked";
    case UnrefinedReason::kEffort: return "effort";
    case UnrefinedReason::kOutputRounding: return "output_rounding";
    case UnrefinedReason::kSurfaceTolerance: return "surface_tolerance";
  }
  return "";
}

}  // namespace remesh
