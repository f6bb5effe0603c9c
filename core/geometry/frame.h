/// The plane frame of a patch: one map from space to the plane, computed once and stored.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// Right-handed: x_axis cross y_axis = normal, all unit. Plane coordinates are
/// ((p - origin) . x_axis, (p - origin) . y_axis) / scale, then rounded to `grid`; they lie within [-1, 1].
struct Frame {
  Vec3 origin;
  Vec3 x_axis{1, 0, 0};
  Vec3 y_axis{0, 1, 0};
  Vec3 normal{0, 0, 1};
  double scale = 1;  ///< a power of two, model units
  double grid = 0;  ///< plane coordinates are multiples of this power of two: 2^-40, or 2^-100 where that merges points
};

}  // namespace remesh
