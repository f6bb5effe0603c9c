/// Surfaces of no kind.
#pragma once

#include <cmath>

#include "core/mesh/mesh.h"
#include "tests/support/shapes.h"

namespace remesh {

/// A ball with waves on it, of 2 * 4^(levels + 1) faces.
inline PolygonMesh bumpy_ball(int levels) {
  PolygonMesh ball = shapes::sphere(levels);
  for (Vec3& p : ball.positions) {
    const Vec3 n = normalized(p);
    p = (0.8 + 0.05 * std::sin(5 * n.x + 1) * std::sin(4 * n.y + 2) * std::cos(6 * n.z)) * n;
  }
  return ball;
}

/// A square of hills with 2 n^2 faces. Its outline is plane, and the hills are up to 0.1 high.
inline PolygonMesh hills(int n) {
  PolygonMesh square = shapes::sheet(1.6, 1.6, n, n);
  for (Vec3& p : square.positions) {
    p = p - Vec3{0.8, 0.8, 0};
    p.z = 0.1 * std::sin(4 * p.x) * std::cos(5 * p.y);
  }
  return square;
}

}  // namespace remesh
