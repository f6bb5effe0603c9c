#include "core/report.h"

namespace remesh {

std::string_view status_name(PatchStatus status) {
  switch (status) {
    case PatchStatus::kRemeshed: return "remeshed";
    case PatchStatus::kReduced: return "reduced";
    case PatchStatus::kKept: return "kept";
  }
  return "";
}

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
  }
  return "";
}

std::string_view diagnostic_name(DiagnosticCode code) {
  switch (code) {
    case DiagnosticCode::kDuplicateVertex: return "duplicate_vertex";
    case DiagnosticCode::kDuplicateFace: return "duplicate_face";
    case DiagnosticCode::kZeroAreaFace: return "zero_area_face";
    case DiagnosticCode::kTJunction: return "t_junction";
    case DiagnosticCode::kInconsistentWinding: return "inconsistent_winding";
    case DiagnosticCode::kInsideOut: return "inside_out";
    case DiagnosticCode::kNonManifoldEdge: return "non_manifold_edge";
    case DiagnosticCode::kNonManifoldVertex: return "non_manifold_vertex";
    case DiagnosticCode::kOpenBoundary: return "open_boundary";
    case DiagnosticCode::kSelfIntersection: return "self_intersection";
    case DiagnosticCode::kOverlappingFaces: return "overlapping_faces";
    case DiagnosticCode::kUnusedVertex: return "unused_vertex";
    case DiagnosticCode::kNonplanarPolygon: return "nonplanar_polygon";
    case DiagnosticCode::kAttributeDropped: return "attribute_dropped";
    case DiagnosticCode::kTrailingBytes: return "trailing_bytes";
    case DiagnosticCode::kCurvedSurface: return "curved_surface";
    case DiagnosticCode::kSmallDihedral: return "small_dihedral";
    case DiagnosticCode::kSeam: return "seam";
    case DiagnosticCode::kRoundingCapped: return "rounding_capped";
  }
  return "";
}

}  // namespace remesh
