/// Affine maps of space, as formats have them that place meshes several times.
#pragma once

#include <array>

#include "core/base/vec.h"

namespace remesh {

/// An affine map: the columns of its matrix, and the point to which it takes 0.
struct AffineMap {
  std::array<Vec3, 3> columns{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Vec3 origin;

  Vec3 turned(const Vec3& p) const { return p.x * columns[0] + p.y * columns[1] + p.z * columns[2]; }
  /// Holds: a map that moves no point leaves their bits as they are, also those of a zero with a sign.
  Vec3 operator()(const Vec3& p) const {
    const Vec3 moved = turned(p) + origin;
    return moved == p ? p : moved;
  }
  /// The map that does `inner` first.
  AffineMap after(const AffineMap& inner) const {
    return {{turned(inner.columns[0]), turned(inner.columns[1]), turned(inner.columns[2])}, (*this)(inner.origin)};
  }
  /// True if it mirrors, so that outsides become insides.
  bool turns_over() const { return dot(cross(columns[0], columns[1]), columns[2]) < 0; }
};

}  // namespace remesh
