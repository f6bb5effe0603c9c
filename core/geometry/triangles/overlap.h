/// Tests whether two triangles lie on each other.
#pragma once

#include <span>

#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Returns whether two triangles lie in one plane, within the tolerance and in either orientation, and cover a common
/// area there.
/// Holds:   the result is symmetric up to rounding. For exactly coplanar triangles it is exact, as far as the
///          projection preserves areas.
bool do_overlap(const Triangle& f, const Triangle& g, std::span<const Vec3> positions, double tolerance);

/// The approximate place where two triangles intersect: the middle of the intersection of their boxes.
Vec3 meeting_place(const Triangle& f, const Triangle& g, std::span<const Vec3> positions);

}  // namespace remesh
