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

/// Three directions at right angles to each other, each of length 1, to rounding: the coordinates of something flat
/// that lies askew in space.
struct Axes {
  Vec3 x{1, 0, 0};
  Vec3 y{0, 1, 0};
  Vec3 z{0, 0, 1};

  Axes() = default;
  explicit Axes(const Frame& frame) : x(frame.x_axis), y(frame.y_axis), z(frame.normal) {}

  Vec3 along(const Vec3& p) const { return {dot(x, p), dot(y, p), dot(z, p)}; }
  Vec3 in_space(const Vec3& p) const { return p.x * x + p.y * y + p.z * z; }
};

}  // namespace remesh
