/// Surfaces of no kind.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/mesh/mesh.h"
#include "tests/support/shapes.h"

namespace remesh {

/// The radius of a ball with waves on it, in a direction of length 1.
inline double bumpy_radius(const Vec3& n) {
  return 0.8 + 0.05 * std::sin(5 * n.x + 1) * std::sin(4 * n.y + 2) * std::cos(6 * n.z);
}

/// A ball with waves on it, of 2 * 4^(levels + 1) faces.
inline PolygonMesh bumpy_ball(int levels) {
  PolygonMesh ball = shapes::sphere(levels);
  for (Vec3& p : ball.positions) {
    const Vec3 n = normalized(p);
    p = bumpy_radius(n) * n;
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

/// A block whose upper side is hills, and whose other sides are planes of many facets.
inline PolygonMesh relief(int n) {
  PolygonMesh block = shapes::box({1.6, 1.6, 0.5}, n);
  double bottom = block.positions[VertexId(0)].z;
  for (const Vec3& p : block.positions) bottom = std::min(bottom, p.z);
  for (Vec3& p : block.positions) p.z = bottom + (p.z - bottom) * (1 + 0.2 * std::sin(4 * p.x) * std::cos(5 * p.y));
  return block;
}

/// Hills with 2 n^2 faces that are flat along the lines x = -0.8 and x = 0.8. Beyond the second one, a surface of 2 n
/// needles goes on to x = 3, straight in that direction; each needle has a plane of its own. Beside the last of them, a
/// parallelogram of two triangles goes on smoothly to y = 1.2. Beyond the first line, a rectangle as narrow as the
/// needles, of two triangles in the plane z = 0, goes on to x = -3.
inline PolygonMesh hills_with_needles(int n) {
  std::vector<Vec3> positions;
  const auto along = [n](int i) { return -0.8 + 1.6 * i / n; };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const double x = along(i), y = along(j);
      const bool is_flat = i == 0 || i == n;
      positions.push_back({x, y, is_flat ? 0 : 0.1 * std::sin(4 * x) * std::cos(5 * y) * (1 - x * x / 0.64)});
    }
  std::vector<std::vector<std::uint32_t>> faces;
  const auto add_quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  };
  const auto row = static_cast<std::uint32_t>(n) + 1;
  for (std::uint32_t j = 0; j + 1 < row; ++j)
    for (std::uint32_t i = 0; i + 1 < row; ++i)
      add_quad(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i);
  const auto far = static_cast<std::uint32_t>(positions.size());
  for (int j = 0; j <= n; ++j) positions.push_back({3, along(j), 0.05 * std::cos(6 * along(j))});
  for (std::uint32_t j = 0; j + 1 < row; ++j) add_quad(j * row + row - 1, far + j, far + j + 1, j * row + 2 * row - 1);
  const std::uint32_t last = row * row - 1, far_last = far + row - 1, wide = far_last + 1;
  for (const std::uint32_t v : {last, far_last}) positions.push_back(positions[v] + Vec3{0, 0.4, 0.12});
  add_quad(last, far_last, wide + 1, wide);
  const std::uint32_t half = row / 2, rectangle = wide + 2;
  positions.push_back({-3, along(n / 2), 0});
  positions.push_back({-3, along(n / 2 + 1), 0});
  add_quad(rectangle, half * row, (half + 1) * row, rectangle + 1);
  return shapes::from_lists(positions, faces);
}

/// A round boss of this many sides whose top is a surface of no kind.
inline PolygonMesh wavy_boss(int sides) {
  std::vector<Vec3> positions{{0, 0, 1.05}};
  std::vector<std::vector<std::uint32_t>> faces;
  const auto n = static_cast<std::uint32_t>(sides), rings = n / 6;
  const auto ring = [&](double radius, double height) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * 3.14159265358979323846 * i / n;
      const Vec3 p{radius * std::cos(angle), radius * std::sin(angle), 0};
      positions.push_back({p.x, p.y, height > 0 ? height + 0.1 * std::sin(4 * p.x + 1) * std::cos(5 * p.y) : 0});
    }
  };
  for (std::uint32_t r = 1; r <= rings; ++r) ring(static_cast<double>(r) / rings, 1);
  ring(1, 0);
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    faces.push_back({0, 1 + i, 1 + j});
    for (std::uint32_t r = 1; r < rings; ++r) {
      const std::uint32_t inner = 1 + (r - 1) * n, outer = 1 + r * n;
      faces.push_back({inner + i, outer + i, outer + j});
      faces.push_back({inner + i, outer + j, inner + j});
    }
    faces.push_back({1 + (rings - 1) * n + i, 1 + rings * n + i, 1 + rings * n + j, 1 + (rings - 1) * n + j});
  }
  std::vector<std::uint32_t> bottom;
  for (std::uint32_t i = n; i-- > 0;) bottom.push_back(1 + rings * n + i);
  faces.push_back(bottom);
  return shapes::from_lists(positions, faces);
}

}  // namespace remesh
