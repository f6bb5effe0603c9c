/// The order of the faces around an edge, and which of them bound one solid there.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A triangle at the edge from a to b.
struct FaceAtEdge {
  Vec3 apex;                ///< the third corner
  bool is_forward = false;  ///< the triangle runs from a to b, not from b to a
  std::uint32_t layer = 0;  ///< orders faces in one plane with the same orientation; the smallest is next to the solid
  std::uint32_t tag = 0;    ///< identifies the face for the caller; also orders faces with equal layers
};

/// Pairs the faces at an edge that bound one solid from both sides, with no other pair between them. This works like
/// nested parentheses: a face behind which the solid begins opens one, and a face at which the solid ends closes one.
/// Faces in one plane are treated as if each were moved against its normal by an infinitesimal. So two faces back to
/// back are the walls of two solids. Faces with the same orientation are moved by different infinitesimals, in the
/// order of their `layer`.
/// Input:  coordinates in the range of orient3d. The function sorts `faces`, and removes those whose corners lie on a
///         line.
/// Output: the tags of the two faces of each pair.
/// Errors: kCancelled, kTimeout - asked to stop through `control`.
/// Cost:   O(k log k) for k faces.
std::vector<std::pair<std::uint32_t, std::uint32_t>> pair_faces_around_edge(const Vec3& a, const Vec3& b,
                                                                            std::vector<FaceAtEdge>& faces,
                                                                            const RunControl& control);

}  // namespace remesh
