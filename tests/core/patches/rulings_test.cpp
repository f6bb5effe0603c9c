#include "core/patches/charts/rulings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace remesh {
namespace {

using Pair = std::array<std::uint32_t, 2>;

/// The outline of half of a cylinder or cone about the z axis: `lower` pieces below and `upper` pieces above.
struct Half {
  CurvedChart chart;
  std::vector<Vec3> positions;
  std::vector<Vec2> places;
  std::vector<Pair> sides;
  std::size_t above;  ///< the first vertex of the upper curve

  /// Input: the functions give the place of a vertex from its angle.
  Half(const AnalyticSurface& shape, int lower, int upper, const std::function<Vec3(double)>& below,
       const std::function<Vec3(double)>& top)
      : chart(CurvedPatch{SurfaceId(0),
                          SurfaceMap(shape, {below(std::numbers::pi / 2), false}),
                          {1, 0.05, std::numbers::pi / 4, 1, 1}}),
        above(static_cast<std::size_t>(lower) + 1) {
    for (int i = 0; i <= lower; ++i) positions.push_back(below(std::numbers::pi * i / lower));
    for (int i = upper; i >= 0; --i) positions.push_back(top(std::numbers::pi * i / upper));
    for (std::uint32_t v = 0; v < positions.size(); ++v) {
      places.push_back(chart.map().flat(positions[v]));
      sides.push_back({v, (v + 1) % static_cast<std::uint32_t>(positions.size())});
    }
  }

  std::vector<Pair> rulings() const {
    RunControl control;
    return find_rulings(chart, {positions, places, sides}, control);
  }
};

std::function<Vec3(double)> circle(double radius, double z, double slope = 0) {
  return [=](double angle) {
    return Vec3{radius * std::cos(angle), radius * std::sin(angle), z + slope * std::sin(angle)};
  };
}

AnalyticSurface cylinder(double radius) {
  AnalyticSurface shape{SurfaceKind::kCylinder, {0, 0, 0}, {0, 0, 1}};
  shape.radius = radius;
  return shape;
}

TEST(rulings, join_the_vertices_of_two_equal_curves) {
  const Half half(cylinder(2), 6, 6, circle(2, 0), circle(2, 5));
  const std::vector<Pair> rulings = half.rulings();
  // The first and the last ruling are sides already.
  ASSERT_EQ(rulings.size(), 5u);
  for (const auto& [a, b] : rulings) {
    EXPECT_NE(a < half.above, b < half.above);
    EXPECT_NEAR(half.positions[a].x, half.positions[b].x, 1e-12);
    EXPECT_NEAR(half.positions[a].y, half.positions[b].y, 1e-12);
  }
}

TEST(rulings, join_no_vertices_at_different_angles) {
  for (const Pair& pair : Half(cylinder(2), 6, 4, circle(2, 0), circle(2, 5)).rulings()) {
    // With six pieces below and four above, only the vertices in the middle face each other.
    EXPECT_EQ(pair[0] + pair[1], 3u + 9u);
  }
  EXPECT_EQ(Half(cylinder(2), 6, 4, circle(2, 0), circle(2, 5)).rulings().size(), 1u);
  EXPECT_TRUE(Half(cylinder(2), 6, 7, circle(2, 0), circle(2, 5)).rulings().empty());
}

TEST(rulings, keep_away_from_sharp_corners) {
  // Where the cut is steep, its sides make an angle of less than 60 degrees with the rulings.
  const double slope = 2 * 2.0;
  const Half half(cylinder(2), 12, 12, circle(2, 0), circle(2, 9, slope));
  const std::vector<Pair> rulings = half.rulings();
  EXPECT_FALSE(rulings.empty());
  EXPECT_LT(rulings.size(), 11u);
  for (const auto& [a, b] : rulings) {
    const std::uint32_t top = std::max(a, b);
    for (const std::uint32_t next : {top - 1, top + 1}) {
      const Vec3 side = half.positions[next] - half.positions[top], down{0, 0, -1};
      EXPECT_LT(dot(side, down) / norm(side), std::cos(58 * std::numbers::pi / 180)) << top;
    }
  }
}

TEST(rulings, of_a_cone_lead_towards_its_apex) {
  AnalyticSurface cone{SurfaceKind::kCone, {0, 0, 6}, {0, 0, -1}};
  cone.half_angle = std::atan(0.5);
  const Half half(cone, 6, 6, circle(3, 0), circle(1, 4));
  const std::vector<Pair> rulings = half.rulings();
  ASSERT_EQ(rulings.size(), 5u);
  for (const auto& [a, b] : rulings)
    EXPECT_NEAR(norm(cross(half.positions[a] - cone.origin, half.positions[b] - cone.origin)), 0, 1e-12);
}

TEST(rulings, exist_on_cylinders_and_cones_alone) {
  AnalyticSurface torus{SurfaceKind::kTorus, {0, 0, 0}, {0, 0, 1}};
  torus.radius = 4;
  torus.minor_radius = 1;
  EXPECT_TRUE(Half(torus, 6, 6, circle(5, 0), circle(4, 1)).rulings().empty());
}

}  // namespace
}  // namespace remesh
