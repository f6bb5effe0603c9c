/// Whether two triangles lie on each other.
#pragma once

#include <span>

#include "core/base/vec.h"
#include "core/mesh/mesh.h"

namespace remesh {

/// Do two triangles lie in one plane, within the tolerance and whichever way they look, and cover there a common area?
/// Holds:   symmetric but for rounding; with exactly coplanar triangles exact, as far as the projection keeps areas.
bool do_overlap(const Triangle& f, const Triangle& g, std::span<const Vec3> positions, double tolerance);

/// A place where two triangles that intersect do so, about: the middle of what their boxes have in common.
Vec3 meeting_place(const Triangle& f, const Triangle& g, std::span<const Vec3> positions);

}  // namespace remesh
