#include "core/base/diagnostic.h"

namespace remesh {

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
    case DiagnosticCode::kClosedHole: return "closed_hole";
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
    case DiagnosticCode::kManyFaces: return "many_faces";
    case DiagnosticCode::kIncompleteCheck: return "incomplete_check";
    case DiagnosticCode::kRemovedDetail: return "removed_detail";
    case DiagnosticCode::kSmallDetail: return "small_detail";
    case DiagnosticCode::kOutputAsText: return "output_as_text";
    case DiagnosticCode::kRenamedLabels: return "renamed_labels";
    case DiagnosticCode::kCutIntersections: return "cut_intersections";
    case DiagnosticCode::kSharedFaces: return "shared_faces";
    case DiagnosticCode::kDroppedPieces: return "dropped_pieces";
  }
  return "";
}

}  // namespace remesh
