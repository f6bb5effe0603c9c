/// Faces around one edge, by the half-planes that it bounds.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"

namespace remesh {

/// A face at an edge, like the page of a book.
struct Page {
  VertexId apex;  ///< the corner that is not on the edge
  FaceId face;
};

/// Sorts the faces at an edge so that those in one half-plane about it stand next to each other. Others meet in the
/// edge alone.
/// Input:   two different places; coordinates in the range of predicates_3d.h.
/// Output:  where the groups end in `pages`, ascending; within a group faces are in ascending order. Faces without area
///          that go on beyond one end of the edge make a group, too; each of those that do not stands alone.
/// Holds:   exact.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
std::vector<std::uint32_t> group_by_half_plane(const Vec3& from, const Vec3& to, std::span<const Vec3> positions,
                                               std::vector<Page>& pages, RunControl& control);

}  // namespace remesh
