/// Tells which faces of the working surface have no area.
#pragma once

#include <vector>

#include "core/base/ids.h"
#include "core/base/run_control.h"
#include "core/base/vec.h"
#include "core/mesh/surface.h"

namespace remesh {

/// Returns whether a face is a triangle with exactly collinear corners. After mend_faces there are few such faces, or
/// none.
bool is_without_area(const Surface& surface, FaceId f);
std::vector<FaceId> faces_without_area(const Surface& surface, RunControl& control);

/// Returns whether three points are exactly on one line (or coincide).
bool is_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace remesh
