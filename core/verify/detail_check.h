/// Proves the distance between a surface and the same surface without its details.
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
/// Output: the max distance of any point of either surface from the other surface, in model units. It is the max move
///         of a corner of a piece, plus rounding. The result is empty if the map proves nothing. The map is a proof if
///         all of the following holds:
/// - The pieces of each triangle cover it: after edges in opposite directions have cancelled, their remaining edges are
///   the triangle's outline, with points on it in their order along the edges.
/// - Each piece becomes a face of the other surface, or an edge or a vertex of one. Exactly one piece becomes each
///   face, with its corners in the same order. So every closed surface stays closed.
/// - Or all corners of a piece are anchored at one point of a face of the other surface. Then so are all pieces that
///   are connected with it.
/// - The Euler number of the part that is not anchored has not grown. It would grow by 2 if a handle were pinched off.
///   It may grow by 1 with each rim whose image has no open edge left, for example the rim of a slit; rims with
///   connected images count once. It falls by 1 with each removed flap that has two sides, because the two sides are a
///   closed surface of their own.
/// Errors:  kCancelled, kTimeout - asked to stop through `control`.
/// Cost:    O(n log n).
std::optional<double> prove_details(const DetailClaim& claim, RunControl& control);

}  // namespace remesh
