/// Decides where the long sides of narrow strips, such as the facets of cylinders and fillets, are best cut.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/patch_types/patch_mesh.h"
#include "core/refinement/goals/goals.h"
#include "core/refinement/segments/segment_table.h"
#include "core/refinement/sizes/size_field.h"

namespace remesh {

/// Returns the smallest angle, in degrees, that triangles in a row along a strip aim at. Even if the bound on angles is
/// lower, triangles are not made flatter there: flatter ones would save few faces and make worse tetrahedra. Behind
/// thin walls, where sizes vary, steeper triangles are better still. See experiments.md, Strips.
inline double least_strip_angle_deg(const SizeField& sizes) { return sizes.is_uniform() ? 30 : 36; }

/// Along a strip, the bound on angles decides how long the pieces of the sides may be. If the sides were halved again
/// and again, pieces could be as short as half of the allowed length. If both sides were cut at the same places, the
/// triangles over the pieces would have right angles. Then the bound allows only pieces half as long, and a size that
/// is not much more than the width forbids the long sides of those triangles. So the two sides of a strip are cut into
/// the same number of equal parts, and the parts of one side end between those of the other. The same division
/// continues from strip to strip as long as strips are alike. This needs only a third to a half of the faces.
///
/// Behind a wall of one thickness, facets with a few rows of triangles are such strips, too. Every second row ends half
/// a piece later. So the pieces of the two sides begin alike if the number of rows is even, and half a piece apart if
/// it is odd. The rim of the wall, which is as wide as its pieces are long, is no strip: there it is best if both sides
/// of the wall are cut alike.
/// Input:  `feature` has the distance from each segment to its nearest feature in model units. The table has its
///         segments and sides.
/// Output: One entry per segment. It is one part for segments that are not sides of strips. It is one part, too, for
///         sides of strips that have room for a row of points inside, if the size varies along the side, is the same
///         everywhere on the surface, or asks for very many rows.
std::vector<EvenParts> parts_along_strips(const PatchMeshes& meshes, const SegmentTable& table,
                                          std::span<const double> feature, const Goals& goals, const SizeField& sizes,
                                          RunControl& control);

}  // namespace remesh
