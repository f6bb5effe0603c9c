/// Groups the faces around an edge by the half-planes that the edge bounds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A face at an edge, like a page at the spine of a book.
struct Page {
  VertexId apex;  ///< the corner that is not on the edge
  FaceId face;
};

/// Sorts the faces at an edge so that faces in one half-plane about it stand next to each other. Faces in different
/// half-planes meet only in the edge.
/// Input:   `from` and `to` must be at different places, and coordinates in the range of predicates_3d.h.
/// Output:  the ends of the groups in `pages`, ascending. Within a group, faces are in ascending order. Faces without
///          area that reach beyond one end of the edge make a group, too. Each face without area that does not reach
///          beyond is a group of its own.
/// Holds:   the result is exact.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
std::vector<std::uint32_t> group_by_half_plane(const Vec3& from, const Vec3& to, std::span<const Vec3> positions,
                                               std::vector<Page>& pages, RunControl& control);

}  // namespace remesh
