/// Which side stays of walls that stand back to back.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/geometry/shells.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Two faces over one loop that look opposite ways, the first of which is the smaller one.
struct BackToBack {
  FaceId first, second;
  bool is_first_kept = true;
};

/// Of each two faces one is to go. Chooses for pairs that are connected together, so that those that stay look the same
/// way over each edge, and also the same way as what they border on. Where they border on nothing else they are two
/// shells, and one of these goes:
/// - If they have different labels they are walls of two bodies, and the one that looks outwards stays: as a body of
///   its own in another one it is right.
/// - Else the one with the smallest face stays.
/// - A shell that would look the wrong way then (geometry/inside_out.h) goes after all, and the other one stays.
/// Input:   the pairs, each of whose edges has two faces if one face of each pair goes. `is_dropped`, by face, is set
///          for all others that go, and for the second ones. `labels` are those of the input, `of_faces` those of the
///          faces.
/// Output:  is_first_kept. Pieces with one side only are left as they were.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
void choose_sides(const Surface& surface, const Adjacency& edges, const FaceLabels& labels, const BodyLabels& of_faces,
                  std::span<const std::uint8_t> is_dropped, std::span<BackToBack> pairs, RunControl& control);

}  // namespace remesh
