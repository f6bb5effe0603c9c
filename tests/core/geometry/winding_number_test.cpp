#include "core/geometry/shells/winding_number.h"

#include <gtest/gtest.h>

#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

double winding_number(const PolygonMesh& mesh, const Vec3& p) {
  RunControl control;
  const TriangleMesh triangles = shapes::as_triangles(mesh);
  return WindingNumber(triangles.positions.items(), triangles.faces.items(), control).at(p);
}

TEST(winding_number, it_is_1_in_a_closed_surface_and_0_outside) {
  Random random(base_seed(36));
  const PolygonMesh ball = shapes::sphere(4);
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
    if (norm(p) > 0.9 && norm(p) < 1.01) continue;
    EXPECT_NEAR(winding_number(ball, p), norm(p) < 1 ? 1 : 0, 0.03) << p.x << " " << p.y << " " << p.z;
    EXPECT_NEAR(winding_number(shapes::turned_over(ball), p), norm(p) < 1 ? -1 : 0, 0.03);
  }
}

TEST(winding_number, it_is_the_part_of_all_directions_that_is_covered) {
  // Of a cube, as seen from its middle, each side covers a sixth.
  PolygonMesh cube = shapes::quad_box({2, 2, 2});
  for (std::size_t sides = 6; sides > 0; --sides) {
    cube.face_begin.resize(sides + 1);
    cube.corners.resize(4 * sides);
    const PolygonMesh open = shapes::fan_triangulated(cube);
    EXPECT_NEAR(winding_number(open, {1, 1, 1}), static_cast<double>(sides) / 6, 1e-9);
    EXPECT_NEAR(winding_number(shapes::scaled(open, 0x1p240), {0x1p240, 0x1p240, 0x1p240}),
                static_cast<double>(sides) / 6, 1e-9);
  }
}

}  // namespace
}  // namespace remesh
