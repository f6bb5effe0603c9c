// Tests which edges of a curved patch are too long, against points along the edges.

#include "core/patches/charts/curved_chart.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "tests/support/random.h"

namespace remesh {
namespace {

constexpr Vec3 kUp{0, 0, 1};

CurvedChart chart_of(const AnalyticSurface& shape, double max_height, double max_turn) {
  CurvedPatch patch{SurfaceId(0), SurfaceMap(shape, {{1, 0, 1}, false}), {}, 0};
  patch.limits.tolerance = patch.limits.max_height = max_height;
  patch.limits.max_turn = max_turn;
  return CurvedChart(patch);
}

/// Returns a point of a cone whose apex is at the origin, by its distance from the axis and its angle around it.
Vec3 on_cone(double half_angle, double radius, double around) {
  return {radius * std::cos(around), radius * std::sin(around), radius / std::tan(half_angle)};
}

/// Returns the largest distance of many points of a segment from a surface.
double sampled_depth(const AnalyticSurface& shape, const Vec3& a, const Vec3& b) {
  constexpr int kSamples = 400;
  double depth = 0;
  for (int i = 0; i <= kSamples; ++i)
    depth = std::max(depth, std::fabs(shape.distance(a + static_cast<double>(i) / kSamples * (b - a))));
  return depth;
}

TEST(curved_chart, an_edge_is_bent_if_a_point_of_it_is_too_deep) {
  Random random(base_seed(8112));
  const auto part = [&] { return random.unit(); };
  constexpr double kMaxHeight = 0.02;
  int deep = 0, flat = 0;
  for (int i = 0; i < 20000; ++i) {
    const double half_angle = 0.1 + 1.3 * part(), sixth = std::numbers::pi / 3;
    const AnalyticSurface cone{SurfaceKind::kCone, {}, kUp, 0, 0, half_angle};
    const AnalyticSurface ball{SurfaceKind::kSphere, {}, {}, 1, 0, 0};
    const AnalyticSurface cylinder{SurfaceKind::kCylinder, {}, kUp, 1, 0, 0};
    // Far enough from the apex, edges may turn by a sixth of a circle at most, so the depth alone decides.
    const double around = sixth * part(), radius = 0.8 + part(), other = 0.8 + part();
    const double low = part(), high = part(), tilt = 0.4 * part();
    const std::vector<std::tuple<AnalyticSurface, Vec3, Vec3>> edges{
        {cone, on_cone(half_angle, radius, 0), on_cone(half_angle, other, around)},
        {cylinder, {1, 0, low}, {std::cos(around), std::sin(around), high}},
        {ball,
         {1, 0, 0},
         {std::cos(tilt) * std::cos(around / 2), std::cos(tilt) * std::sin(around / 2), std::sin(tilt)}}};
    for (const auto& [shape, a, b] : edges) {
      const double limit = shape.kind == SurfaceKind::kSphere ? CurvedChart::kDepthOfEdges * kMaxHeight : kMaxHeight;
      const CurvedChart chart = chart_of(shape, kMaxHeight, sixth);
      const bool is_bent = chart.is_bent(chart.space_point(a), chart.space_point(b));
      const double depth = sampled_depth(shape, a, b);
      if (depth > limit * 1.001) {
        EXPECT_TRUE(is_bent);
        ++deep;
      }
      // Samples miss the deepest place by a little.
      if (depth < limit * 0.999) {
        EXPECT_FALSE(is_bent);
        ++flat;
      }
    }
  }
  EXPECT_GT(deep, 10000);
  EXPECT_GT(flat, 10000);
}

TEST(curved_chart, edges_beside_an_apex_turn_by_a_third_of_a_circle_at_most) {
  for (const double half_angle : {0.1, 0.5, 1.0, 1.3, 1.5}) {
    SCOPED_TRACE(half_angle);
    const CurvedChart chart = chart_of({SurfaceKind::kCone, {}, kUp, 0, 0, half_angle}, 0.1, std::numbers::pi / 8);
    const auto is_bent = [&](double radius, double degrees) {
      return chart.is_bent(chart.space_point(on_cone(half_angle, radius, 0)),
                           chart.space_point(on_cone(half_angle, radius, degrees * std::numbers::pi / 180)));
    };
    EXPECT_FALSE(is_bent(0.01, 119));
    EXPECT_TRUE(is_bent(0.01, 121));
    EXPECT_TRUE(is_bent(0.01, 180));
    // Farther away, they are too deep, or turn by more than was asked for.
    EXPECT_TRUE(is_bent(40, 119));
    EXPECT_TRUE(is_bent(40, 180));
  }
}

}  // namespace
}  // namespace remesh
