/// Faces that repeat another one.
#pragma once

#include <vector>

#include "core/base/diagnostic.h"
#include "core/base/run_control.h"
#include "core/mending/mend.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Finds faces over the same loop of vertices and drops all but one of each: the one whose labels are on the smallest
/// part of the surface, so that a wall that two bodies have is that of the inner one; among equals the first.
/// A face that repeats another one seen from behind is dropped only where that is right: where, with all of its
/// connected kind gone, each of its edges has exactly two faces. Else it stays: it is the other side of a sheet, or
/// the wall of a second solid, and without it the surface would be open or would have edges of three faces. Which of
/// the two is dropped does not depend on their order where their labels or what is around them tells (back_to_back.h).
/// A face that repeats another one and looks the same way stays only where it is the wall of a second body, one of the
/// two mirrored: where with it as many faces run one way as the other along an edge, and without it not.
/// Input:   a welded surface, and the labels of the input that it came from. A polygon that touches itself is not looked
///          at.
/// Output:  the surface without them, with Mend::kYes. Counts duplicate_face, those dropped and those left apart.
/// Returns: whether the surface changed.
/// Cost:    O(n log n) where faces repeat others seen from behind; else O(n).
bool drop_duplicate_faces(Surface& surface, const Adjacency& edges, const FaceLabels& labels, Mend mend,
                          std::vector<Diagnostic>& diagnostics, RunControl& control);

}  // namespace remesh
