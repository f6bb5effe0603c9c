/// Moves a curved surface outwards without changing its kind.
#pragma once

#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// Returns the surface outside of a cylinder, sphere or torus, or inside of it if the offset is negative: its radius,
/// or that of its tube, grows by the offset. A cone keeps its apex, and its half angle grows by the offset, in radians.
/// So a cone moves farther where its circles are larger, as its facets are deeper there.
/// Input: a cylinder, cone, sphere or torus.
AnalyticSurface offset_surface(const AnalyticSurface& shape, double offset);

/// Returns how far the surface moves outwards at a point of it, per small offset.
/// Input: as for offset_surface.
double offset_lever(const AnalyticSurface& shape, const Vec3& p);

}  // namespace remesh
