#include "core/verify/model/curved_shape.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace remesh::verification {
namespace {

const std::vector<AnalyticSurface> kShapes{{SurfaceKind::kCylinder, {0.1, 0.2, 0}, {0, 0, 1}, 0.5, 0, 0},
                                           {SurfaceKind::kCone, {0, 0.1, -0.3}, {0, 0, 1}, 0, 0, 0.4},
                                           {SurfaceKind::kCone, {0, 0, 0}, {0, 0, 1}, 0, 0, 1.3},
                                           {SurfaceKind::kSphere, {0.1, 0, 0}, {}, 0.7, 0, 0},
                                           {SurfaceKind::kTorus, {0, 0, 0.1}, {0, 0, 1}, 0.6, 0.2, 0},
                                           {SurfaceKind::kTorus, {0, 0, 0}, {0, 0, 1}, 0.2, 0.3, 0}};

/// A point on the surface, by the formulas of AnalyticSurface's description and with the axis along z.
Vec3 on_surface(const AnalyticSurface& s, double u, double v) {
  double rho = s.radius, z = v;
  if (s.kind == SurfaceKind::kCone) rho = v * std::tan(s.half_angle);
  if (s.kind == SurfaceKind::kSphere) {
    rho = s.radius * std::cos(v);
    z = s.radius * std::sin(v);
  }
  if (s.kind == SurfaceKind::kTorus) {
    rho = s.radius + s.minor_radius * std::cos(v);
    z = s.minor_radius * std::sin(v);
  }
  return s.origin + Vec3{rho * std::cos(u), rho * std::sin(u), z};
}

Vec3 at(const std::vector<Vec3>& corners, double s, double t) {
  return corners[0] + s * (corners[1] - corners[0]) + t * (corners[2] - corners[0]);
}

/// A random triangle with corners near a surface.
std::vector<Vec3> triangle_at(const AnalyticSurface& s, std::mt19937& random) {
  const auto any = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  const double u = any(0, 2 * std::numbers::pi), v = any(0.2, 1), size = std::pow(10, any(-3, 0));
  std::vector<Vec3> corners;
  for (int i = 0; i < 3; ++i) {
    const Vec3 off{any(-0.02, 0.02), any(-0.02, 0.02), any(-0.02, 0.02)};
    corners.push_back(on_surface(s, u + any(-1, 1) * size, v + any(-0.2, 0.2) * size) + size * off);
  }
  return corners;
}

TEST(curved_shape, the_distance_and_the_normal_are_those_of_the_surface_moved_along_its_normal) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> any(0.1, 1);
  for (const AnalyticSurface& s : kShapes) {
    const CurvedShape shape(s, 1);
    ASSERT_TRUE(shape.is_sound());
    for (int i = 0; i < 100; ++i) {
      const double u = any(random), v = any(random), h = 1e-6;
      const Vec3 p = on_surface(s, u, v);
      const Vec3 du = on_surface(s, u + h, v) - on_surface(s, u - h, v);
      const Vec3 dv = on_surface(s, u, v + h) - on_surface(s, u, v - h);
      const Vec3 normal = normalized(cross(du, dv));
      EXPECT_NEAR(shape.distance(p), 0, 1e-14);
      for (const double off : {-0.04, 0.05}) {
        EXPECT_NEAR(shape.distance(p + off * normal), off, 1e-8);
        EXPECT_LT(norm(shape.normal(p + off * normal) - normal), 1e-7);
      }
    }
  }
}

TEST(curved_shape, no_place_of_a_face_is_outside_of_the_bounds_and_the_bounds_are_tight) {
  std::mt19937 random(2);
  for (const AnalyticSurface& s : kShapes) {
    const CurvedShape shape(s, 1);
    int sure = 0;
    for (int i = 0; i < 400; ++i) {
      std::vector<Vec3> corners = triangle_at(s, random);
      const Vec3 normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
      const CurvedFace face = shape.read(corners, 0, {});
      Range seen, facing;
      constexpr int kSteps = 60;
      for (int a = 0; a <= kSteps; ++a)
        for (int b = 0; a + b <= kSteps; ++b) {
          const Vec3 p = at(corners, a / double(kSteps), b / double(kSteps));
          seen.add(shape.distance(p));
          facing.add(dot(normal, shape.normal(p)));
        }
      EXPECT_LE(face.distance.low, seen.low);
      EXPECT_GE(face.distance.high, seen.high);
      const double width = seen.high - seen.low;
      EXPECT_GE(face.distance.low, seen.low - 0.05 * width - 1e-13) << int(s.kind) << " " << i;
      EXPECT_LE(face.distance.high, seen.high + 0.05 * width + 1e-13) << int(s.kind) << " " << i;
      // The bounds of the facing are true, and they leave little open.
      if (face.facing.low > 0) {
        EXPECT_GT(facing.low, 0);
      }
      if (face.facing.high < 0) {
        EXPECT_LT(facing.high, 0);
      }
      const bool is_sure = face.facing.low > 0 || face.facing.high < 0;
      sure += is_sure;
      if (facing.low > 0.05 || facing.high < -0.05) {
        EXPECT_TRUE(is_sure) << int(s.kind) << " " << i;
      }
    }
    EXPECT_GT(sure, 100);
  }
}

TEST(curved_shape, a_polygon_has_the_bounds_of_its_triangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-0.6, 0.6);
  for (const AnalyticSurface& s : kShapes) {
    const CurvedShape shape(s, 1);
    int compared = 0;
    for (int i = 0; i < 300; ++i) {
      // A random plane with an L in it, which is not convex.
      const Vec3 origin{any(random), any(random), any(random)};
      const Vec3 x = normalized(Vec3{any(random), any(random), any(random)});
      const Vec3 y = normalized(cross(x, Vec3{any(random), any(random), any(random)}));
      std::vector<Vec3> corners;
      for (const Vec2 p : {Vec2{0, 0}, Vec2{2, 0}, Vec2{2, 1}, Vec2{1, 1}, Vec2{1, 2}, Vec2{0, 2}})
        corners.push_back(origin + 0.2 * p.x * x + 0.2 * p.y * y);
      Range of_triangles;
      for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
        std::vector<Vec3> triangle{corners[a], corners[b], corners[c]};
        of_triangles.add(shape.read(triangle, 0, {}).distance);
      }
      const CurvedFace face = shape.read(corners, 0, {});
      // Faces that meet the axis are refused. Their bounds are rough.
      if (face.facing.low <= -1) continue;
      ++compared;
      const double slack = s.kind == SurfaceKind::kTorus ? (of_triangles.high - of_triangles.low) / 30 : 1e-13;
      EXPECT_NEAR(face.distance.low, of_triangles.low, slack) << int(s.kind);
      EXPECT_NEAR(face.distance.high, of_triangles.high, slack) << int(s.kind);
    }
    EXPECT_GT(compared, 50) << int(s.kind);
  }
}

TEST(curved_shape, a_turn_of_the_normal_is_within_its_rate) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const AnalyticSurface& s : kShapes) {
    const CurvedShape shape(s, 1);
    int tested = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = on_surface(s, any(random), 0.6 + 0.3 * any(random));
      const Vec3 q = p + 0.1 * Vec3{any(random), any(random), any(random)};
      const double rate = shape.turn_rate(p, shape.turning_length(q - p));
      if (!std::isfinite(rate)) continue;
      EXPECT_LE(norm(shape.normal(q) - shape.normal(p)), rate * shape.turning_length(q - p) * (1 + 1e-9));
      EXPECT_LE(std::fabs(shape.distance(p + 0.3 * (q - p))), shape.depth_between(p, q) + 1e-15);
      ++tested;
    }
    EXPECT_GT(tested, 500) << int(s.kind);
  }
}

TEST(curved_shape, solid_angles_of_an_octant_add_up_to_an_eighth_of_the_sphere) {
  const CurvedShape ball({SurfaceKind::kSphere, {}, {}, 0.5, 0, 0}, 1);
  std::vector<Vec3> octant{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}};
  EXPECT_NEAR(ball.read(octant, 0, {}).area.low, ball.area() / 8, 1e-14);
  EXPECT_NEAR(ball.area(), std::numbers::pi, 1e-14);
}

TEST(curved_shape, the_area_that_a_face_covers_on_a_torus_is_within_its_bounds) {
  const AnalyticSurface torus{SurfaceKind::kTorus, {}, {0, 0, 1}, 0.6, 0.25, 0};
  const CurvedShape shape(torus, 1);
  constexpr int kAround = 48, kTube = 24;
  Range sum{0, 0};
  for (int i = 0; i < kAround; ++i)
    for (int j = 0; j < kTube; ++j) {
      const auto corner = [&](int a, int b) {
        return on_surface(torus, 2 * std::numbers::pi * a / kAround, 2 * std::numbers::pi * b / kTube);
      };
      for (const bool is_upper : {false, true}) {
        const Vec3 a = corner(i, j), b = is_upper ? corner(i, j + 1) : corner(i + 1, j), c = corner(i + 1, j + 1);
        std::vector<Vec3> face{a, is_upper ? c : b, is_upper ? b : c};
        const Range area = shape.read(face, 0, {}).area;
        sum.low += area.low;
        sum.high += area.high;
      }
    }
  EXPECT_LT(sum.low, shape.area());
  EXPECT_GT(sum.high, shape.area());
  EXPECT_GT(sum.low, 0.8 * shape.area());
  EXPECT_LT(sum.high, 1.2 * shape.area());
}

TEST(curved_shape, surfaces_without_sound_numbers_are_told) {
  const auto is_sound = [](const AnalyticSurface& s) { return CurvedShape(s, 1).is_sound(); };
  const Vec3 up{0, 0, 1};
  EXPECT_TRUE(is_sound({SurfaceKind::kCylinder, {}, up, 1, 0, 0}));
  EXPECT_FALSE(is_sound({SurfaceKind::kCylinder, {}, up, 0, 0, 0}));
  EXPECT_FALSE(is_sound({SurfaceKind::kCylinder, {}, {0, 0, 1.001}, 1, 0, 0}));
  EXPECT_FALSE(is_sound({SurfaceKind::kCylinder, {HUGE_VAL, 0, 0}, up, 1, 0, 0}));
  EXPECT_FALSE(is_sound({SurfaceKind::kCone, {}, up, 0, 0, 0}));
  EXPECT_FALSE(is_sound({SurfaceKind::kCone, {}, up, 0, 0, 1.6}));
  EXPECT_FALSE(is_sound({SurfaceKind::kTorus, {}, up, 1, 0, 0}));
  EXPECT_FALSE(is_sound({SurfaceKind::kPlane, {}, up, 1, 1, 1}));
  EXPECT_FALSE(is_sound({SurfaceKind::kFree, {}, up, 1, 1, 1}));
}

}  // namespace
}  // namespace remesh::verification
