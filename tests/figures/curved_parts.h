/// The parts in the pictures of curved surfaces. Their facets are flat, and their coordinates are rounded to six
/// decimals, as in an export.
#pragma once

#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh::figures {

/// The number of facets around the turned part.
inline constexpr int kTurnedSides = 32;

/// Returns a point at a height along the axis of the turned part, which is the y axis.
Vec3 turned_point(double height, double radius, double angle_deg);

/// Makes a part as from a lathe. From left to right it has a bore, a chamfer, a shaft with a fillet, a collar with a
/// round edge, a grip whose outline is no circle, and a ball.
PolygonMesh make_turned_part();

/// Makes a shaft with a flat along its length. The four corners of the flat lie on the shaft's cylinder.
PolygonMesh make_flattened_shaft();

/// Makes a hexagon nut with a round bore. The edges of the six sides lie on a cylinder, too.
PolygonMesh make_nut();

/// Makes a flange: a round plate with four holes, and a boss with a chamfer and a bore. All circles have the same
/// number of facets, which is a multiple of 8.
PolygonMesh make_flange(int sides);

/// Makes an ellipsoid with three different axes.
PolygonMesh make_ellipsoid();

/// Makes a round stone with bumps, of no kind, as a scanner sees it: triangles of one size all over.
PolygonMesh make_stone();

}  // namespace remesh::figures
