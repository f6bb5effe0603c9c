/// Narrow strips, such as the facets of cylinders and fillets: where their long sides are best cut.
#pragma once

#include <span>
#include <vector>

#include "core/base/run_control.h"
#include "core/geometry/patch_mesh.h"
#include "core/refinement/goals.h"
#include "core/refinement/segment_table.h"
#include "core/refinement/size_field.h"

namespace remesh {

/// Degrees: a lower bound on angles is no reason for flatter triangles in a row along a strip. They would save few
/// faces and make worse tetrahedra (TetGen's worst dihedral angle on plates and prisms: 2.2 degrees at 25, 4.2 at 32).
/// Behind thin walls, where sizes vary, steeper ones are better still (a plate with holes, a tray and a coupling: 3.9,
/// 4.7 and 1.7 degrees at 30; 5.8, 6.0 and 3.4 at 36; no better beyond).
inline double least_strip_angle_deg(const SizeField& sizes) { return sizes.is_uniform() ? 30 : 36; }

/// Along a strip the bound on angles says how long the pieces of its sides may be; halves of halves of a side would be
/// as short as half of that. And where both sides are cut at the same places, the triangles over the pieces have right
/// angles: the bound allows only pieces half as long, and a size that is not much more than the width forbids the long
/// sides of those triangles. So the sides of a strip are cut into equal parts, as many on either, those of one side
/// between those of the other, from strip to strip as far as they are alike: a third to a half of the faces.
///
/// Behind a wall of one thickness, facets of a few rows of triangles are such strips, too: every second row ends half a
/// piece later, so the sides' pieces begin alike where rows are even, and half a piece later where they are odd. The
/// wall's rim, as wide as its pieces are long, is none: what is alike on both sides of the wall is best.
/// Input:  of each segment the distance to the nearest feature, model units; the table has its segments and sides.
/// Output: one a segment; 1 for those that are no sides of strips, or of such as have room for a row of points inside
///         and a size that varies, is the same everywhere on the surface, or asks for a great many rows.
std::vector<EvenParts> parts_along_strips(const std::vector<PatchMesh>& meshes, const SegmentTable& table,
                                          std::span<const double> feature, const Goals& goals, const SizeField& sizes,
                                          RunControl& control);

}  // namespace remesh
