/// The plane frame of a patch. It is one map from space to the plane, computed once and stored.
#pragma once

#include "core/base/vec.h"

namespace remesh {

/// The frame is right-handed: x_axis cross y_axis = normal, and all three have unit length. Plane coordinates are
/// ((p - origin) . x_axis, (p - origin) . y_axis) / scale, rounded to `grid`. They lie within [-1, 1].
struct Frame {
  Vec3 origin;
  Vec3 x_axis{1, 0, 0};
  Vec3 y_axis{0, 1, 0};
  Vec3 normal{0, 0, 1};
  double scale = 1;  ///< a power of two, in model units
  /// Plane coordinates are multiples of this power of two. It is 2^-40, or 2^-100 if that would merge points.
  double grid = 0;
};

/// Three orthogonal unit vectors, up to rounding. They give coordinates to something flat that lies askew in space.
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
