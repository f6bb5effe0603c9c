/// Chooses which side of a wall stays if two faces stand back to back.
#pragma once

#include <cstdint>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/shells/shells.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Two faces with the same loop of vertices and opposite orientations. The first one has the smaller number.
struct BackToBack {
  FaceId first, second;
  bool does_first_stay = true;
};

/// One face of each pair is to be dropped, and this function chooses which one. It decides for all connected pairs
/// together, so that the faces that stay have the same orientation as each other and as the faces that they border on.
/// If connected pairs border on nothing else, they form two shells, and one of these is dropped:
/// - If the two have different labels, they are walls of two bodies, and the shell that faces outwards stays: it may be
///   a body of its own inside another body.
/// - Otherwise the one with the smallest face stays.
/// - If the shell that would stay by these rules has the wrong orientation (inside_out.h), the other one
///   stays.
/// Input:   the pairs. If one face of each pair goes, each of their edges has two faces. `is_dropped` has one entry per
///          face, and is set for all other faces that go and for the second faces of the pairs. `labels` are those of
///          the input, `of_faces` those of the faces.
/// Output:  does_first_stay. Connected pairs without two consistent sides are left as they were.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
void choose_sides(const Surface& surface, const Adjacency& edges, const FaceLabels& labels, const BodyLabels& of_faces,
                  std::span<const std::uint8_t> is_dropped, std::span<BackToBack> pairs, RunControl& control);

}  // namespace remesh
