/// A plane in space.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// A plane in local units.
struct Plane {
  Vec3 origin;
  Vec3 normal;

  double distance(const Vec3& p) const { return dot(p - origin, normal); }
};

}  // namespace remesh
