#include "core/geometry/shells/winding_number.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

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

TEST(winding_number, among_many_shells_it_is_as_near_to_a_whole_number_as_is_asked) {
  Random random(base_seed(37));
  PolygonMesh balls;
  std::vector<Vec3> centres;
  for (int i = 0; i < 200; ++i) {
    centres.push_back({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)});
    balls = shapes::joined(balls, shapes::moved(shapes::sphere(3), centres.back()));
  }
  const TriangleMesh triangles = shapes::as_triangles(balls);
  RunControl control;
  const WindingNumber winding(triangles.positions.items(), triangles.faces.items(), control);
  double largest = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    const auto is_near_a_surface = [&](const Vec3& centre) { return std::fabs(norm(p - centre) - 0.99) < 0.011; };
    if (std::any_of(centres.begin(), centres.end(), is_near_a_surface)) continue;
    const auto around = std::count_if(centres.begin(), centres.end(), [&](const Vec3& c) { return norm(p - c) < 1; });
    largest = std::max(largest, std::fabs(winding.at(p) - static_cast<double>(around)));
    EXPECT_NEAR(winding.at(p, 32), static_cast<double>(around), 1e-3);
  }
  EXPECT_GT(largest, 0.01) << "the surfaces are too simple for a test";
}

}  // namespace
}  // namespace remesh
