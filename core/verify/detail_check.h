/// Proves how far a surface is from one without its details.
#pragma once

#include <optional>
#include <span>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mending/details/detail_map.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// The claim that a map takes one triangulated surface onto another. Both are in model units.
struct DetailClaim {
  std::span<const Vec3> positions_before;
  std::span<const Triangle> faces_before;
  std::span<const Vec3> positions_after;
  std::span<const Triangle> faces_after;
  const DetailMap& map;
};

/// Tests a map from one surface onto another. It shares no code with the removal of details.
/// Output:  how far any point of either surface is from the other surface at most, in model units. That is as far as a
///          corner of a piece moves, plus rounding. Nothing if the map proves nothing. It does if all of the following
///          holds:
/// - The pieces of each triangle cover it: what is left of their edges, where edges in opposite directions cancel, is
///   the triangle's outline, with points on it in their order along the edges.
/// - Each piece becomes a face of the other surface, or an edge or a vertex of one, and each face is what exactly one
///   piece becomes, with its corners in the same order. So every closed surface stays closed.
/// - Or all corners of a piece are anchored at one point of a face of the other surface. Then all pieces that it hangs
///   together with are, too.
/// - The Euler number of what is not anchored has not grown, as it would by 2 if a handle were pinched off. It may grow
///   by 1 with each rim whose image has no open edge left, as that of a slit; rims whose images hang together count
///   once. It falls by 1 with each flap that goes and has two
///   sides, since the two sides are a closed surface of their own.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
std::optional<double> prove_details(const DetailClaim& claim, RunControl& control);

}  // namespace remesh
