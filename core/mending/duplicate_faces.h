/// Drops faces that repeat another face.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Finds faces over the same loop of vertices, and drops all but one of them. The one whose labels are on the smallest
/// part of the surface stays, so that a wall which two bodies share becomes that of the inner body. Among equals, the
/// first one stays.
/// Two kinds of faces may stay all the same:
/// - A face that repeats another one with the opposite orientation. It is dropped only if, with all such faces gone
///   that are connected with it, each of its edges has exactly two faces. Otherwise it is the other side of a sheet, or
///   the wall of a second solid, and without it the surface would be open or would have edges with three faces. Which
///   face of the pair is dropped does not depend on their order, if their labels or the faces around them decide it
///   (back_to_back.h).
/// - A face that repeats another one with the same orientation. It stays only if it is the wall of a second body, where
///   one of the two is mirrored. This is so if along one of its edges as many faces run one way as the other with it,
///   but not without it.
/// Input:   a welded surface, and the labels of the input that it came from. Polygons that touch themselves are
///          ignored.
/// Output:  with Mend::kYes, the surface without the dropped faces. Counts faces that are dropped and faces that are
///          left, each as duplicate_face.
/// Returns: whether the surface changed.
/// Cost:    O(n log n) if faces repeat others with the opposite orientation; otherwise O(n).
bool drop_duplicate_faces(Surface& surface, const Adjacency& edges, const FaceLabels& labels, Mend mend,
                          std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
