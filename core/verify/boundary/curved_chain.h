/// Compares a boundary chain of the input with the output's, where a patch beside it is curved.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"

namespace remesh::verification {

/// The distance of two chains, for one of the patches beside them.
struct PatchGap {
  PatchId patch;
  /// For a curved patch: the max distance of the nearest points on its surface, if both chains are followed at once.
  double on_surface = 0;
  /// For a curved patch: the max distance of the two chains from each other near a pole or an apex, where the surface
  /// turns too fast for `on_surface`.
  double near_pole = 0;
  double off_plane = 0;  ///< for a plane: the max distance of the chains along its normal
};

struct ChainGap {
  double distance = 0;  ///< max distance if both chains are followed at once (their Frechet distance, or more)
  double sliver = 0;    ///< area of a ribbon of triangles between them
  std::vector<PatchGap> patches;  ///< one for each patch beside them
};

/// Measures two chains from end to end. All of its numbers are upper bounds, up to rounding.
///
/// This is why `on_surface` is a bound. Let x and y be the two points, v = x - y, and N the normal of the surface.
/// While a point moves straight from y to x, its nearest point on the surface moves only by the part of v across N, and
/// by no more than 1 + |d| c times as much, where d is the distance from the surface and c a bound on the turn of N per
/// length. On a short piece of the chains, N is compared with the normal n in the middle of the output's piece. N
/// differs from n by no more than c times the way across N between the two places: half of the piece, and the part of v
/// across N. That part is at most the part across n plus |v| |N - n|, which bounds |N - n|. The difference v is linear
/// on a piece, so the part of it across a fixed normal is largest at an end.
///
/// At a cylinder or a cone, the way of the nearest point is measured along the rulings and around the axis instead.
/// There, the nearest point of a point at the height z over the apex and the distance rho from the axis is z cos a +
/// rho sin a along its ruling, at the same angle about the axis. On a straight way, z is linear, the angle changes in
/// one direction, and rho is convex: it lies below a linear function by no more than an eighth of its second
/// derivative, which is p^2 / rho^3, where p is the distance of the way's line from the axis times the length of the
/// way across the axis. An angle deviates from a linear one by no more than an eighth of the square of that length over
/// rho. From the ends of a piece, this bounds the way along the rulings and the turn w about the axis. The gap is the
/// root of the sum of the squares of the former and of (r + h cos a) w, with the largest distance r of the nearest
/// points from the axis and the largest depth h, as curved_patch.h proves.
///
/// Input:  `input`, `output` - at least two points each, in the numbered claim's scale, in the same direction; `uses` -
///         the faces along the chain.
/// Cost:   O((vertices of both) * uses). Edges of the input are cut into no more than 64 parts.
ChainGap measure_gap(const NumberedClaim& numbered, std::span<const Vec3> input, std::span<const Vec3> output,
                     std::span<const Use> uses, RunControl& control);

}  // namespace remesh::verification
