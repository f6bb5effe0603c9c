/// Estimates how many faces fill a curved surface.
#pragma once

#include "core/base/vec.h"
#include "core/geometry/surfaces/analytic_surface.h"

namespace remesh {

/// Returns how many faces fill an area of a curved surface if edges turn by one radian. Twice as many edges make four
/// times as many faces. In most cases the number is right within a factor of 2.
/// Input:  a place of the area. `by_angle`: a min angle is in force.
/// Source: experiments.md, Prediction of curved patches.
double curved_faces_at_one(const AnalyticSurface& shape, const Vec3& at, double area, bool by_angle);

}  // namespace remesh
