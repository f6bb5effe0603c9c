/// Checks a curved patch: its output must be the same piece of the claimed surface as its input.
///
/// Let S be the claimed cylinder, cone, sphere or torus, without a cone's apex, and d the signed distance from it. This
/// is why the check proves the distance in both directions, once the boundary is right (boundary.h):
///  - Shell: the values of d over all input faces lie in a range [A, B], those over all output faces in [a, b]. Both
///    are measured over whole faces (curved_shape.h), not at their corners. All of these values are within the
///    tolerance, which is less than the distance at which normals of S meet. So each point has one nearest point on S.
///  - Facing: all over each face, input or output, the angle between its normal and the normal of S is below a right
///    angle, or all over each face it is above a right angle, as in a hole. So the map to the nearest point on S is one
///    to one near each place of each face, and it turns none of them over.
///  - Covering: hence a point of S is under as many input faces as the boundary of the input, moved to S, winds around
///    it, up to one constant for all of S. For a cylinder or a cone the constant is 0, because far away no point is
///    under any face. The same is true of the output. Chains of the input's boundary correspond to chains of the
///    output's. If one is moved straight to the other and this way is moved to S, it sweeps slivers on S. Outside of
///    these slivers, input and output cover a point equally often, up to the constant. For a sphere or a torus the
///    constant is the difference of the areas that both cover on S, divided by the area of S and rounded, if slivers
///    and errors together are smaller than the area of S. It must be 0.
///  - So above a point q of S outside of the slivers, for each point of one side there is a point of the other on the
///    same normal, and it is no farther than D = max(B - a, b - A).
///  - In a sliver, q lies on a way on S, at most g long, between the nearest points of a point of the input's chain and
///    of a point y of the output's chain. Let x be the point above q, q' the nearest point of y, N and N' the normals
///    there, d and d' the distances of x and y from S, h a bound on these, and c a bound on the turn of the normal per
///    length of the way. So |N - N'| <= c g, and q - q' is at most g long, with parts along N and N' of at most c g^2 /
///    2. Hence |x - y|^2 = |q - q' + d N - d' N'|^2 <= g^2 + (d - d')^2 + h^2 c^2 g^2 + 2 h c g^2 <= D^2 + ((1 + h c)
///    g)^2. PatchGap::on_surface is a bound on (1 + h c) g. Near an apex, where c is not bounded, the triangle
///    inequality gives D + 2 g' with the distance g' between the chains themselves (PatchGap::near_pole).
///  - At a cylinder, or a cone of the half angle a, the normal does not turn along a ruling, so less is added. Let the
///    way be l long along the rulings, turn by w around the axis, and be no farther than r from it. Then |q - q'|^2 <=
///    l^2 + (r w)^2, |N - N'| <= w cos a, and the parts of q - q' along N and N' are at most r w^2 cos(a) / 2. The same
///    sum gives |x - y|^2 <= D^2 + l^2 + ((r + h cos a) w)^2, and PatchGap::on_surface bounds the root of the last two.
///  - Corners near a cone's apex are moved to it first, and the largest of these moves counts twice.
/// - Faces lower than the plane tolerance may face anywhere, because noise decides that. If they face the wrong way,
///   their height is added to (1 + h c) g: within that distance of them, there are faces for which the proof holds.
#pragma once

#include <vector>

#include "core/base/run_control.h"
#include "core/verify/boundary/boundary.h"
#include "core/verify/claim/verification_faults.h"
#include "core/verify/model/edge_table.h"
#include "core/verify/model/numbered_claim.h"
#include "core/verify/patches/shape_sums.h"

namespace remesh::verification {

/// Reports kNoFaces, kSurface, kDeviation, kFacingAway, kArea, kZeroArea, kInverted, kCover, kUnexplained.
/// A patch whose faces are all unchanged is not compared with its surface.
/// Input:  a patch with a curved surface.
/// Output: the proven distance between its input and its output; `sums` get its share.
/// Cost:   O(n); for a torus, a face may cost as much as 1,024.
double check_curved_patch(const NumberedClaim& numbered, const EdgeTable& input_edges, const Boundary& boundary,
                          PatchId patch, ShapeSums& sums, std::vector<FoundFault>& faults, RunControl& control);

}  // namespace remesh::verification
