#include "core/mending/polygons/triangulated.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/mending/weld/weld.h"
#include "tests/support/shapes.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

TEST(triangulated, polygons_come_as_triangles_of_their_area) {
  RunControl control;
  const PolygonMesh mesh = shapes::prism({{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, 2);
  const Surface surface = mended(mesh);
  const Triangulated triangles(surface, control);
  EXPECT_EQ(triangles.size(), 2u * 4 + 6 * 2);
  double area = 0, volume = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles.triangle(t);
    const Vec3 p = surface.positions[a], q = surface.positions[b], r = surface.positions[c];
    area += norm(cross(q - p, r - p)) / 2;
    volume += dot(p, cross(q, r)) / 6;
  }
  EXPECT_DOUBLE_EQ(area, 2 * 5 + 2 * 12);
  EXPECT_DOUBLE_EQ(volume, 10);
  for (std::uint32_t f = 0; f < surface.face_count(); ++f) {
    const std::size_t first = triangles.first_of(FaceId(f));
    EXPECT_EQ(triangles.face(first), FaceId(f));
    EXPECT_TRUE(first == 0 || triangles.face(first - 1) < FaceId(f));
  }
}

TEST(triangulated, triangles_are_the_surface_s_own) {
  RunControl control;
  const Surface surface = mended(shapes::box({1, 2, 3}, 2));
  const Triangulated triangles(surface, control);
  EXPECT_EQ(triangles.corners().data(), surface.corners.items().data());
  EXPECT_EQ(triangles.size(), surface.face_count());
  EXPECT_EQ(triangles.face(7), FaceId(7));
  EXPECT_EQ(triangles.first_of(FaceId(7)), 7u);
}

}  // namespace
}  // namespace remesh
