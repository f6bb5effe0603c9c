/// Drops faces that repeat another face.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/common/mend_mode.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Finds faces over the same loop of vertices, and drops all but one of them. The one whose labels are on the smallest
/// part of the surface stays, so that a wall which two bodies share becomes that of the inner body. Among equals, a
/// whole face of the input stays rather than a piece of one, and then the first one.
/// Two kinds of faces may still stay:
/// - A face that repeats another one with the opposite orientation. Such pairs that are connected over edges without
///   other faces are a sheet, and each sheet is judged by itself. One face of each pair is dropped if each edge of the
///   sheet has exactly two faces then. Which one that is does not depend on their order, if their labels or the faces
///   around them decide it (back_to_back.h). Both faces are dropped if the sheet is a fin: it has a free edge, and
///   stands on nothing but closed surfaces. Otherwise the sheet lies in an open surface or alone, or it is the wall
///   between two solids. Without one of its sides, the surface would be open or would have edges with three faces.
/// - A face that repeats another one with the same orientation. It stays only if it is the wall of a second body, where
///   one of the two is mirrored. This is so if the faces along one of its edges run equally often in both directions
///   with this face, and not without it.
/// Input:   a welded surface, and the labels of the input that it came from. Polygons that touch themselves are
///          ignored.
/// Output:  with MendMode::kYes, the surface without the dropped faces. Counts faces that are dropped, those of fins,
///          and faces that are left, each as duplicate_face. Vertices that only fins have go with them.
/// Returns: whether the surface changed.
/// Cost:    O(n log n) if faces repeat others with the opposite orientation; otherwise O(n).
bool drop_duplicate_faces(Surface& surface, const Adjacency& edges, const FaceLabels& labels, MendMode mend,
                          std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
