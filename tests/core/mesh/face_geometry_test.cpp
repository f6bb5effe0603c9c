#include "core/mesh/face_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/invariance.h"
#include "tests/support/random.h"
#include "tests/support/shapes.h"

namespace remesh {
namespace {

/// Returns the geometry of the first face. Its coordinates are taken as local units.
FaceGeometry geometry_of(const PolygonMesh& mesh) {
  Surface surface = shapes::surface(mesh);
  surface.local.items().assign(surface.positions.begin(), surface.positions.end());
  RunControl control;
  return face_geometry(surface, control)[FaceId(0)];
}

void expect_near(const Vec3& a, const Vec3& b, double error = 1e-14) {
  EXPECT_NEAR(a.x, b.x, error);
  EXPECT_NEAR(a.y, b.y, error);
  EXPECT_NEAR(a.z, b.z, error);
}

TEST(face_geometry, a_triangle_of_sides_3_4_5) {
  const FaceGeometry g = geometry_of(shapes::from_lists({{0, 0, 1}, {4, 0, 1}, {0, 3, 1}}, {{0, 1, 2}}));
  EXPECT_DOUBLE_EQ(g.area, 6);
  EXPECT_DOUBLE_EQ(g.height, 12.0 / 5);
  expect_near(g.normal, {0, 0, 1});
}

TEST(face_geometry, the_centre_is_the_mean_of_the_corners) {
  Surface surface = shapes::surface(shapes::from_lists({{0, 0, 1}, {4, 0, 1}, {0, 3, 1}}, {{0, 1, 2}}));
  surface.local.items().assign(surface.positions.begin(), surface.positions.end());
  expect_near(face_centre(surface, FaceId(0)), {4.0 / 3, 1, 1});
}

TEST(face_geometry, the_height_of_a_triangle_is_its_least_one) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vec3> p;
    for (int i = 0; i < 3; ++i) p.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    double least = HUGE_VAL;
    for (int i = 0; i < 3; ++i) {
      const Vec3 side = p[(i + 1) % 3] - p[i], other = p[(i + 2) % 3] - p[i];
      least = std::min(least, norm(other - (dot(other, side) / norm_squared(side)) * side));
    }
    EXPECT_NEAR(geometry_of(shapes::from_lists(p, {{0, 1, 2}})).height, least, 1e-12);
  }
}

TEST(face_geometry, a_concave_polygon_has_its_own_area_and_looks_its_way) {
  // The reflex corner first: a fan from it would count twice what it should subtract.
  const FaceGeometry g = geometry_of(shapes::polygon({{1, 1}, {1, 2}, {0, 2}, {0, 0}, {2, 0}, {2, 1}}));
  EXPECT_DOUBLE_EQ(g.area, 3);
  expect_near(g.normal, {0, 0, 1});
  EXPECT_DOUBLE_EQ(g.height, 2 * 3 / std::sqrt(8.0));
}

TEST(face_geometry, a_hole_through_a_bridge_is_not_counted) {
  const FaceGeometry g =
      geometry_of(shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0, 8}, {0, 0}, {2, 2}, {2, 6}, {6, 6}, {6, 2}, {2, 2}}));
  EXPECT_DOUBLE_EQ(g.area, 64 - 16);
}

TEST(face_geometry, a_needle_without_a_direction_gets_one_across_its_longest_side) {
  const FaceGeometry g = geometry_of(shapes::from_lists({{0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5}}, {{0, 1, 2}}));
  EXPECT_NEAR(norm(g.normal), 1, 1e-14);
  EXPECT_NEAR(dot(g.normal, {1, 1, 1}), 0, 1e-14);
  EXPECT_EQ(g.area, 0);
  EXPECT_EQ(g.height, 0);
}

TEST(face_geometry, local_units_are_what_counts) {
  Surface surface = shapes::surface(shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}));
  surface.unit = 4;
  for (const Vec3& p : surface.positions) surface.local.push_back(0.25 * p);
  RunControl control;
  EXPECT_DOUBLE_EQ(face_geometry(surface, control)[FaceId(0)].area, 6.0 / 16);
}

STAGE(face_geometry, test::kStop) {
  const Surface surface = shapes::surface(shapes::sheet(1, 1, 2, 2));
  (void)face_geometry(surface, trial.control);
}

}  // namespace
}  // namespace remesh
