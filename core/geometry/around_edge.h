/// The order of faces around an edge, and which of them bound one solid there.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A triangle at the edge from a to b.
struct FaceAtEdge {
  Vec3 apex;                ///< its third corner
  bool is_forward = false;  ///< it runs from a to b
  std::uint32_t layer = 0;  ///< of those in one plane that look the same way, the smallest is next to the solid
  std::uint32_t tag = 0;    ///< for the caller; where layers are equal this counts
};

/// Pairs the faces at an edge that have solid between them and no other pair there: as in nested parentheses, where a
/// face behind which the solid begins opens one, and a face at which it ends closes one. Faces in one plane count as
/// moved apart by an infinitesimal, each away from the side that it looks to. So back to back they are walls of two
/// solids, and of those that look the same way each has a layer of its own.
/// Input:  coordinates as orient3d takes them. Sorts `faces`. Those whose corners lie on a line are left out.
/// Output: the tags of each pair.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(k log k) for k faces.
std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_around_edge(const Vec3& a, const Vec3& b,
                                                                      std::vector<FaceAtEdge>& faces,
                                                                      const RunControl& control);

}  // namespace remesh
